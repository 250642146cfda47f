//! What a module without a system must have, and never uses.

use core::alloc::{GlobalAlloc, Layout};

/// Nothing here allocates; but a crate that could is linked, and asks for somebody who would.
struct Nothing;

// SAFETY: a null pointer says that there is no memory, and nothing is ever given back.
unsafe impl GlobalAlloc for Nothing {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        core::ptr::null_mut()
    }
    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

#[global_allocator]
static NOTHING: Nothing = Nothing;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
