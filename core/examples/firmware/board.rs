//! What the machine needs to start, speak and stop: a vector table, the floating-point unit, and Arm's semihosting.
#![allow(
    unsafe_code,
    reason = "a machine without an operating system is started and spoken to in assembly"
)]

use core::arch::{asm, global_asm};
use core::panic::PanicInfo;

// The linker script puts the address of the stack's top in front of the vectors. The stack is all of the RAM: it is painted, so
// that how much of it was used can be seen.
global_asm!(
    ".section .vectors, \"a\"",
    ".word reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault",
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xe000ed88", // coprocessor access control: the floating-point unit for everyone
    "ldr r1, [r0]",
    "orr r1, r1, #0xf00000",
    "str r1, [r0]",
    "dsb",
    "isb",
    "ldr r0, =stack_bottom",
    "mov r1, sp",
    "ldr r2, =0xa5a5a5a5",
    "1: cmp r0, r1",
    "beq 2f",
    "stmia r0!, {{r2}}",
    "b 1b",
    "2: bl start",
    ".thumb_func",
    "fault:",
    "movs r0, #3",
    "bl stop",
);

const WRITE_CHARACTER: u32 = 0x03;
const EXIT_EXTENDED: u32 = 0x20;
const APPLICATION_EXIT: u32 = 0x2_0026;

/// Asks the debugger, here QEMU, for a service.
fn semihosting(service: u32, argument: *const u32) {
    // SAFETY: both services only read what the argument points to, one byte or two words; they return in r0.
    unsafe { asm!("bkpt 0xab", inlateout("r0") service => _, in("r1") argument, options(nostack)) }
}

/// Ends the program: 0 all came out as it must, 1 something did not, 2 a panic, 3 a fault.
#[unsafe(no_mangle)]
extern "C" fn stop(code: u32) -> ! {
    loop {
        semihosting(EXIT_EXTENDED, [APPLICATION_EXIT, code].as_ptr());
    }
}

fn write(text: &[u8]) {
    for character in text {
        semihosting(WRITE_CHARACTER, core::ptr::from_ref(character).cast());
    }
}

/// Where the reset ends.
#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    let passed = crate::run(&mut write);
    crate::hexadecimal(&mut write, b"stack         ", stack_used().into(), 8);
    stop(u32::from(!passed))
}

/// How many bytes of the stack were ever written.
fn stack_used() -> u32 {
    unsafe extern "C" {
        static stack_bottom: u32;
        static stack_top: u32;
    }
    let (mut lowest, top) = (&raw const stack_bottom, &raw const stack_top);
    // SAFETY: from the bottom to the top lies the RAM that the reset has painted, word by word.
    while lowest < top && unsafe { lowest.read_volatile() } == 0xa5a5_a5a5 {
        lowest = lowest.wrapping_add(1);
    }
    (top.addr() - lowest.addr()) as u32
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    stop(2)
}
