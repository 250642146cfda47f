//! Tests of [`super::args`].

use super::args::{Aov, Command, ExplainArgs, InfoArgs, Kernel, RenderArgs, Transmittance, parse};
use super::values::Replay;
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

fn command(line: &str) -> Result<Command, clap::Error> {
    parse(
        std::iter::once("woodcock")
            .chain(line.split_whitespace())
            .map(OsString::from),
    )
}

fn render(line: &str) -> RenderArgs {
    match command(line) {
        Ok(Command::Render(args)) => *args,
        other => panic!("{line}: {other:?}"),
    }
}

/// Exit code and message of a refused line.
fn refusal(line: &str) -> (i32, String) {
    let error = command(line).expect_err(line);
    (error.exit_code(), error.to_string())
}

#[test]
fn every_flag_arrives() {
    let args = render(
        "render a.pbrt -o x.exr -o x.png --spp 64 --time 1.5 --seed 18446744073709551615 -t 3 \
         --integrator bdpt --split 8 --connection-bound 2.5 --aov albedo,depth --transmittance ratio --kernel scalar --keep emission --keep surfaces \
         --resolution 640x360 --crop 0,0.5,0,1 --max-depth 100 --stats s.json --max-memory 2G \
         --lenient --quiet",
    );
    assert_eq!(args.scene, Some(PathBuf::from("a.pbrt")));
    assert_eq!(
        args.outputs,
        [PathBuf::from("x.exr"), PathBuf::from("x.png")]
    );
    assert_eq!(args.spp, Some(64));
    assert_eq!(render("--target-error 2%").target_error, Some(0.02));
    assert_eq!(args.time, Some(Duration::from_millis(1500)));
    assert_eq!(args.seed, Some(u64::MAX));
    assert_eq!(args.threads, Some(3));
    assert_eq!(args.integrator.map(|i| i.name()), Some("bdpt"));
    assert_eq!((args.split, args.connection_bound), (Some(8), Some(2.5)));
    assert_eq!(args.aov, [Aov::Albedo, Aov::Depth]);
    assert_eq!(args.transmittance, Some(Transmittance::Ratio));
    assert_eq!(args.kernel, Kernel::Scalar);
    assert_eq!(args.keep, ["emission", "surfaces"]);
    assert_eq!(args.resolution, Some([640, 360]));
    assert_eq!(args.crop, Some([0.0, 0.5, 0.0, 1.0]));
    assert_eq!(args.max_depth, Some(100));
    assert_eq!(args.stats, Some(PathBuf::from("s.json")));
    assert_eq!(args.max_memory, Some(2 << 30));
    assert!(args.lenient && args.quiet);
    let replay = Some(Replay {
        x: 1,
        y: 2,
        sample: 3,
    });
    assert_eq!(render("render --replay 1,2,3").replay, replay);
}

#[test]
fn the_word_render_may_be_left_out() {
    assert_eq!(render(""), render("render"));
    assert_eq!(render("--spp 4"), render("render --spp 4"));
    assert_eq!(render("a.pbrt -o x.exr"), render("render a.pbrt -o x.exr"));
    assert_eq!(
        render("-o x.exr a.pbrt --quiet").scene,
        Some(PathBuf::from("a.pbrt"))
    );
    assert_eq!(refusal("--spp 4 info x.vdb").0, 2);
}

#[test]
fn pbrts_spellings_work() {
    assert_eq!(
        render("--outfile x.exr --nthreads 2 --cropwindow 0,1,0,0.5"),
        render("-o x.exr -t 2 --crop 0,1,0,0.5"),
    );
}

#[test]
fn other_commands() {
    let explain = ExplainArgs {
        scene: Some(PathBuf::from("a.pbrt")),
        ..ExplainArgs::default()
    };
    assert_eq!(
        command("explain a.pbrt").ok(),
        Some(Command::Explain(explain))
    );
    let info = InfoArgs {
        file: PathBuf::from("a.vdb"),
        json: true,
        grid: Some("density".to_owned()),
        at: vec![[-1.0, 2.0, 3.0], [0.0, 0.0, 0.0]],
        ray: vec![[-1.0, 0.0, 0.0, 1.0, 0.0, 0.0]],
        max_memory: None,
    };
    let line = "info a.vdb --json --grid density --at -1,2,3 --at 0,0,0 --ray -1,0,0,1,0,0";
    assert_eq!(command(line).ok(), Some(Command::Info(info)));
}

#[test]
fn usage_errors_exit_with_two() {
    for line in [
        "--no-such-flag",
        "render a.pbrt b.pbrt",
        "--spp 0",
        "--spp many",
        "--time -1",
        "--target-error 0",
        "--target-error 200%",
        "--crop 1,0,0,1",
        "--kernel vector",
        "--transmittance marching",
        "--integrator bogus",
        "--split 0",
        "--connection-bound -1",
        "--aov beauty",
        "-o x.jpg",
        "-o x.exr -o y.exr",
        "--replay 1,2,3 -o x.exr",
        "--quiet --quiet",
        "info",
    ] {
        assert_eq!(refusal(line).0, 2, "{line}");
    }
    assert!(
        refusal("--transmittance marching")
            .1
            .contains("ratio, delta, closed")
    );
    let integrators = "path, bdpt, mlt, single, transmittance";
    assert!(refusal("--integrator bogus").1.contains(integrators));
    for line in ["--help", "--version", "render --help", "info --help"] {
        assert_eq!(refusal(line).0, 0, "{line}");
    }
}

#[test]
fn what_does_not_work_yet_is_refused_and_not_listed() {
    let help = refusal("render --help").1 + &refusal("--help").1;
    for (line, name) in [
        ("--resume", "--resume"),
        ("a.pbrt --shard 1/4", "--shard"),
        ("--display-server localhost:14158", "--display-server"),
        ("merge a.exr -o b.exr", "merge"),
        ("farm slurm a.pbrt -n 4", "farm"),
    ] {
        let (code, message) = refusal(line);
        assert_eq!(code, 2, "{line}");
        assert!(
            message.contains("not yet supported") && message.contains(name),
            "{message}"
        );
        assert!(!help.contains(name), "{name} is listed");
    }
}
