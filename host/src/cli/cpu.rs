//! Does this CPU have the instructions that this binary was compiled for?
//!
//! Without the check an older CPU answers with "illegal instruction". `is_x86_feature_detected!` would not do: it is
//! constantly true for features that are enabled at compile time, so CPUID is read directly.

/// A sentence for the user if the binary cannot run here, else `None`. Call it before anything else.
pub fn missing_features() -> Option<&'static str> {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
    if !has_x86_64_v3() {
        return Some(
            "this binary was built for CPUs with AVX2 (x86-64-v3), which this CPU or its operating system lacks; \
             rebuild it with RUSTFLAGS=\"-Ctarget-cpu=x86-64\" (same images, fewer lanes per instruction)",
        );
    }
    #[cfg(all(target_arch = "x86_64", target_feature = "avx512f"))]
    if !has_x86_64_v4() {
        return Some(
            "this binary was built for CPUs with AVX-512 (x86-64-v4), which this CPU or its operating system lacks; \
             rebuild it without RUSTFLAGS, for AVX2 (same images)",
        );
    }
    None
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
fn all(register: u32, bits: &[u32]) -> bool {
    bits.iter().all(|bit| (register >> bit) & 1 == 1)
}

/// Whether the system saves a part of the registers, by its number in XCR0.
///
/// XGETBV, which says so, is not callable without `unsafe`. Leaf 13 tells the same: EBX of subleaf 0 is the size of the save
/// area for what the system enabled, and a part (its subleaf: size EAX, offset EBX) lies within it only if that is enabled.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
fn saves(part: u32) -> bool {
    use std::arch::x86_64::__cpuid_count;
    let enabled = __cpuid_count(13, 0).ebx;
    let part = __cpuid_count(13, part);
    part.eax > 0 && enabled >= part.ebx + part.eax
}

/// The bits that x86-64-v3 adds to what every 64-bit CPU of the last decade has [Intel SDM vol. 2, CPUID].
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
#[inline(never)]
fn has_x86_64_v3() -> bool {
    use std::arch::x86_64::{__cpuid, __cpuid_count};
    if __cpuid(0).eax < 13 || __cpuid(0x8000_0000).eax < 0x8000_0001 {
        return false;
    }
    // Leaf 1 ECX: FMA 12, MOVBE 22, POPCNT 23, OSXSAVE 27, AVX 28, F16C 29.
    // Leaf 7 EBX: BMI1 3, AVX2 5, BMI2 8. Extended leaf 1 ECX: LZCNT 5.
    let instructions = all(__cpuid(1).ecx, &[12, 22, 23, 27, 28, 29])
        && all(__cpuid_count(7, 0).ebx, &[3, 5, 8])
        && all(__cpuid(0x8000_0001).ecx, &[5]);
    instructions && saves(2)
}

/// The bits that x86-64-v4 adds to x86-64-v3: leaf 7 EBX AVX512F 16, DQ 17, CD 28, BW 30, VL 31; opmasks (5) and both parts of the
/// widest registers (6, 7) saved.
#[cfg(all(target_arch = "x86_64", target_feature = "avx512f"))]
#[inline(never)]
fn has_x86_64_v4() -> bool {
    use std::arch::x86_64::__cpuid_count;
    all(__cpuid_count(7, 0).ebx, &[16, 17, 28, 30, 31]) && [5, 6, 7].into_iter().all(saves)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_cpu_that_runs_this_test_can_run_it() {
        assert_eq!(super::missing_features(), None);
    }
}
