//! Output of the program: statistics, notes, comparisons, help.

use crate::folder::{Folder, SMALL, text};
use serde_json::json;
use spherule_render::image::{Image, WriteOptions};

#[test]
fn statistics_are_one_json_object() {
    let folder = Folder::new();
    let report = folder.json(&[&SMALL[..], &["--json", "--depth", "1"]].concat());
    let statistics = &report["statistics"];
    assert_eq!(statistics["spheres"], 400);
    assert_eq!(statistics["samples"], 40 * 24 * 4);
    assert_eq!(statistics["non_finite_samples"], 0);
    let rays = |class: &str| statistics[class].as_u64().unwrap();
    assert_eq!(rays("rays"), rays("camera_rays") + rays("bounce_rays") + rays("shadow_rays"));
    assert!(rays("cut_paths") > 0);
    assert!(report["warnings"][0].as_str().unwrap().contains("too dark"));
    assert_eq!(report["settings"]["width"], 40);
    assert_eq!(report["settings"]["depth"], 1);
    assert_eq!(report["complete"], true);
}

#[test]
fn renders_report_their_error() {
    let folder = Folder::new();
    let small = ["render", "--size", "40x24", "--quiet", "--json"];
    let report = folder.json(&[&small[..], &["--until-error", "50%"]].concat());
    let noise = &report["noise"];
    assert_eq!((&noise["ended_by"], &noise["confidence"]), (&json!("error"), &json!(0.95)));
    let number = |name: &str| noise[name].as_f64().unwrap();
    assert!(number("error") > 0.0 && number("error") < number("bound") && number("bound") <= 0.5);
    let pixels = 40.0 * 24.0;
    assert_eq!(report["statistics"]["samples"].as_f64().unwrap(), pixels * number("mean_samples"));
    assert_eq!(report["settings"]["spp"], 65_536);
    let coarse = [&small[..3], &["--until-error", "0.01%", "--spp", "16"]].concat();
    let limited = folder.run(&[&coarse[..], &["--stats"]].concat());
    assert!(limited.status.success());
    assert!(text(&limited.stderr).contains("increase --spp"), "{}", text(&limited.stderr));
    assert!(text(&limited.stdout).contains("16.0 samples per pixel (16 to 16)"));
    let line = text(&folder.run(&coarse).stdout).trim_end().to_owned();
    assert!(
        line.starts_with("spherule.png: 40 x 24 pixels in ") && line.contains("error "),
        "{line}"
    );
    assert_eq!(line.lines().count(), 1);
    let timed = folder.json(&[&small[..], &["--time", "10ms"]].concat());
    assert_eq!((&timed["noise"]["ended_by"], &timed["complete"]), (&json!("time"), &json!(true)));
    assert!(folder.json(&[&small[..], &["--spp", "4"]].concat())["noise"].is_null());
}

#[test]
fn images_are_denoised_unless_samples_are_chosen() {
    let folder = Folder::new();
    let small = ["render", "--size", "40x24", "--quiet", "--json"];
    let report = |options: &str| {
        let options: Vec<&str> = options.split_whitespace().collect();
        folder.json(&[&small[..], &options].concat())
    };
    let on = report("--denoise on");
    let noise = &on["noise"];
    assert_eq!((&noise["denoised"], &on["settings"]["denoise"]), (&json!(true), &json!("on")));
    let before = noise["error_before_denoising"].as_f64().unwrap();
    assert!(before > 0.0 && on["settings"]["until_error"] == 0.01);
    let limit = on["settings"]["spp"].as_u64().unwrap();
    assert!(limit <= 1024 && noise["most_samples"].as_u64().unwrap() <= limit);
    let tagged = text(&std::fs::read(folder.path("spherule.png")).unwrap());
    for key in ["denoised", "error before denoising", "error bound"] {
        assert!(tagged.contains(key), "{key}");
    }
    for (options, spp) in [("--denoise off", 64), ("--spp 5", 5), ("--spp 5 --denoise off", 5)] {
        let plain = report(options);
        assert!(plain["noise"].is_null() && plain["settings"]["spp"] == spp, "{options}");
    }
    // Samples that a scene states are those of its image, however it looks best.
    assert!(folder.run(&["field", "--count", "3", "--output", "field.toml"]).status.success());
    let stated = report("field.toml");
    assert_eq!(
        (&stated["noise"]["denoised"], &stated["settings"]["spp"]),
        (&json!(true), &json!(64))
    );
    assert_eq!(stated["statistics"]["samples"], 64 * 40 * 24);
    assert!(report("field.toml --spp 5")["noise"].is_null());
    let same = report("--spp 6 --denoise on");
    assert_eq!(same["noise"]["denoised"], true);
    assert_eq!(same["statistics"]["samples"], 6 * 40 * 24);
    let target = report("--until-error 20% --denoise on");
    assert!(target["noise"]["bound"].as_f64().unwrap() <= 0.2);
    assert_eq!(report("--until-error 20%")["noise"]["denoised"], false);
    let refused = folder.run(&[&small[..3], &["--part", "1/2", "--denoise", "on"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("--denoise on needs the whole image"));
}

#[test]
fn settings_without_effect_are_reported() {
    let folder = Folder::new();
    folder.write("dark.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n");
    let cases = [
        ("--shadow-samples 4", "--shadow-samples has no effect"),
        ("--ao-distance 4", "--ao-distance has no effect"),
        ("--integrator ao --depth 4", "--depth has no effect"),
        ("--integrator ao --roulette none", "--roulette has no effect"),
        ("--integrator ao --light-choice power", "--light-choice has no effect"),
        (
            "--light-choice power",
            "--light-choice has no effect: the scene has fewer than two lights",
        ),
        ("dark.toml --no-caustics", "--no-caustics has no effect"),
        ("--depth 2 --roulette throughput", "--roulette throughput has no effect"),
        ("--traversal scalar --lanes 8", "--lanes has no effect"),
        #[cfg(not(feature = "gpu"))]
        ("--device gpu", "--device gpu has no effect: this program was built without it"),
        ("-o a.exr --exposure 1", "exposure has no effect"),
        ("-o a.pfm --tone filmic", "tone has no effect"),
        ("-o a.pfm --bits 16", "--bits has no effect"),
        ("--ppm plain", "--ppm has no effect"),
        ("dark.toml --integrator whitted --shadow-samples 4", "no lights to sample"),
    ];
    for (line, words) in cases {
        let args: Vec<&str> =
            ["render", "--size", "4x4", "--spp", "1"].into_iter().chain(line.split(' ')).collect();
        let message = text(&folder.run(&args).stderr);
        assert!(message.contains(words), "{line}: {message}");
        let useful = &args[..5];
        assert!(!text(&folder.run(useful).stderr).contains("no effect"));
    }
}

#[test]
fn comparisons_report_errors() {
    let folder = Folder::new();
    let gray = |value: f32| Image::filled(4, 2, [value; 3]).unwrap();
    gray(0.75).write(folder.path("a.pfm"), &WriteOptions::default()).unwrap();
    gray(0.5).write(folder.path("b.pfm"), &WriteOptions::default()).unwrap();
    let report = folder.json(&["compare", "a.pfm", "b.pfm", "--json"]);
    let close = |name: &str, value: f64| (report[name].as_f64().unwrap() - value).abs() < 1e-12;
    assert!(close("rmse", 0.25) && close("bias", 0.25) && close("relative_mse", 0.0625 / 0.26));
    assert!(close("psnr", 20.0 * 4.0_f64.log10()) && close("bias_standard_error", 0.0));
    assert_eq!(report["differing_pixels"], 8);
    assert_eq!(report["max_difference"]["value"], 0.25);
    let same = folder.json(&["compare", "a.pfm", "a.pfm", "--json"]);
    assert!(same["psnr"].is_null() && same["differing_pixels"] == 0);
    assert!(folder.succeed(&["compare", "a.pfm", "b.pfm"]).contains("2.500000e-1"));
    let wide = Image::filled(5, 2, [0.0; 3]).unwrap();
    wide.write(folder.path("wide.pfm"), &WriteOptions::default()).unwrap();
    let output = folder.run(&["compare", "a.pfm", "wide.pfm"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("differ in size"));
}

#[test]
fn every_command_has_help_with_examples() {
    let folder = Folder::new();
    for command in ["render", "field", "info", "compare", "completions"] {
        let help = folder.succeed(&[command, "--help"]);
        assert!(help.contains("Examples:") && help.contains(&format!("spherule {command}")));
    }
    assert!(folder.succeed(&["--help"]).contains("Exit codes"));
    assert!(folder.succeed(&["--version"]).contains(env!("CARGO_PKG_VERSION")));
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(folder.succeed(&["completions", shell]).contains("spp"), "{shell}");
    }
}

#[test]
fn quiet_is_quiet_and_verbose_is_not() {
    let folder = Folder::new();
    let quiet = folder.run(&SMALL);
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let verbose = folder.run(&["render", "--size", "4x4", "--spp", "1", "--verbose"]);
    let message = text(&verbose.stderr);
    assert!(message.contains("found: ") && message.contains("skipped: "), "{message}");
    assert!(text(&verbose.stdout).contains("spherule.png"));
}
