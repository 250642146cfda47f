//! A render that is told to stop finishes its pass, writes what it has, and says so by its exit code.

use super::{FOG, Folder};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Starts an endless render, waits for its first words about progress, sends a signal, and gives the exit code.
fn interrupt(folder: &Folder, signal: &str) -> Option<i32> {
    let mut child = folder
        .command(&[
            "render",
            "fog.pbrt",
            "-t",
            "1",
            "--spp",
            "2000000000",
            "-o",
            "x.exr",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    // Progress is written once rendering has begun, and the program listens before that.
    let mut stderr = child.stderr.take().expect("its words");
    let mut first = [0; 1];
    std::io::Read::read_exact(&mut stderr, &mut first).expect("a first word");
    let killed = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(killed.expect("kill runs").success());
    // Drain, so that the program never waits for a reader.
    std::io::copy(&mut stderr, &mut std::io::sink()).expect("its last words");
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a child") {
            return status.code();
        }
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "it does not stop"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_signal_ends_a_render_with_a_valid_image() {
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::new();
        folder.write("fog.pbrt", FOG);
        assert_eq!(interrupt(&folder, signal), Some(3), "{signal}");
        assert_eq!(folder.names(), ["fog.pbrt", "x.exr"]);
        let image = folder.image("x.exr");
        let stopping = image
            .attributes
            .iter()
            .find(|(n, _)| *n == "woodcock.stopping");
        assert!(format!("{stopping:?}").contains("signal"), "{stopping:?}");
    }
}
