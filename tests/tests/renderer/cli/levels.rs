//! The program on CPUs older and newer than those it was built for, under QEMU's user mode.
//!
//! Needs `qemu-x86_64` (Debian: `qemu-user`), hence ignored: `cargo test -p woodcock-tests --test renderer -- --ignored levels::`.

use super::{FOG, Folder, bits};
use std::process::Command;

/// Runs the program on a CPU: its exit code, and its words on standard error without QEMU's own.
fn on(cpu: &str, folder: &Folder, args: &[&str]) -> (Option<i32>, String) {
    let output = Command::new("qemu-x86_64")
        .args(["-cpu", cpu, env!("CARGO_BIN_EXE_woodcock-under-test")])
        .args(args)
        .current_dir(folder.0.path())
        .output()
        .expect("qemu-x86_64 runs");
    let words = String::from_utf8(output.stderr).expect("text");
    let own = words
        .lines()
        .filter(|line| !line.starts_with("qemu-x86_64:"));
    (output.status.code(), own.collect::<Vec<_>>().join("\n"))
}

#[test]
#[ignore = "needs qemu-x86_64"]
fn an_older_cpu_gets_a_sentence_and_a_newer_one_the_same_bits() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    let render = |name| {
        [
            "fog.pbrt",
            "-q",
            "--spp",
            "2",
            "--resolution",
            "16x12",
            "-o",
            name,
        ]
    };
    // Nehalem has no AVX at all, Sandy Bridge no AVX2.
    for cpu in ["Nehalem", "SandyBridge"] {
        let (code, words) = on(cpu, &folder, &render("old.exr"));
        if cfg!(target_feature = "avx2") {
            assert_eq!(code, Some(1), "{cpu}: {words}");
            assert!(
                words.starts_with("error: this binary was built for CPUs with AVX2"),
                "{words}"
            );
            assert_eq!(words.lines().count(), 1, "{words}");
            assert_eq!(folder.names(), ["fog.pbrt"]);
        } else {
            assert_eq!(code, Some(0), "{cpu}: {words}");
        }
    }
    folder.done(&render("here.exr"));
    let (code, words) = on("Haswell", &folder, &render("haswell.exr"));
    if cfg!(target_feature = "avx512f") {
        assert_eq!(code, Some(1), "{words}");
        assert!(words.contains("AVX-512"), "{words}");
    } else {
        assert_eq!(code, Some(0), "{words}");
        assert!(bits(&folder.image("here.exr")) == bits(&folder.image("haswell.exr")));
    }
}
