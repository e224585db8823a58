//! Examples and exit codes at the end of `--help`.

/// Help of the program.
pub(super) const PROGRAM: &str = "\
Examples:
  spherule                                   a random field of spheres, to spherule.png
  spherule particles.xyz -o figure.png       same as spherule render particles.xyz ...
  spherule ./info                            a file with the name of a command
  spherule render scenes/weekend.toml -o weekend.png
  spherule info scenes/weekend.toml

Exit codes: 0 success, 1 failure, 2 invalid command line, 130 interrupted, 143 terminated";

/// Help of `spherule render`.
pub(super) const RENDER: &str = "\
Examples:
  spherule render                            a random field of spheres, to spherule.png
  spherule render scene.toml -o picture.exr --size 1920x1080 --spp 256
  spherule render scene.toml --until-error 1%       stop at 1% error
  spherule render particles.xyz -o figure.png --integrator ao
  spherule render run.lammpstrj.gz --frame last --radii 0.5 -o last.png
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png
  spherule render run.lammpstrj.gz --frame all --turntable 360 --fps 24 -o video.mp4
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png --skip-existing --part 2/4
  spherule render run.dump --color-by c_pe --color-map inferno --color-bar energy.svg
  spherule render run.gro --legend --axes --scale-bar --label 't = {time} ps' -o figure.pdf
  spherule render protein.pdb --aperture 6 --focus id:1234 -o depth-of-field.png
  spherule render protein.pdb --select 'element != H and chain == A' -o chain.png
  spherule render salt.xyz --type Na:radius=1,material=glass --type Cl:color=#30a030
  spherule render crystal.cif --wrap --replicate 3,3,2 --cell --view auto -o crystal.png
  spherule render protein.pdb --projection orthographic --turntable 90 -o turn.png
  spherule render protein.pdb --preset outline -o outline.png
  spherule render grains.csv --preset studio --up y -o grains.png
  spherule render grains.data --slice 'z>50%' --slice-mode caps -o section.png
  spherule render scene.toml -o - --output-format jpeg | display
  spherule render scene.toml --region 100,50,64x64 -o detail.png
  spherule render scene.toml -o picture.exr --part 3/8     writes picture.3-of-8.part, for merge
  spherule render scene.toml -o picture.exr --part from-env     in a job array or under mpirun
  spherule render scene.toml --prepare scene.prepared     then render scene.prepared
  parallel spherule render scene.toml -o picture.exr --part {}/8 ::: $(seq 8)
  spherule render scene.toml -o picture.exr --layers albedo,normal,depth,id
  spherule render scene.toml --memory-limit 4GB     fails at once if it needs more
  spherule render scene.toml --json --quiet > statistics.json
  spherule render scene.toml --spp 100000 -o long.exr --checkpoint long.checkpoint
  spherule render --resume long.checkpoint          same image as without a stop
  spherule render --resume long.checkpoint --spp 200000 --threads 8

Ctrl-C and SIGTERM save the unfinished image and the checkpoint, and exit with code 130 or 143. A
second signal ends the program at once, without leaving partial files. In a sequence, an unfinished
image is not written, but the checkpoint is.";

/// Help of `spherule merge`.
pub(super) const MERGE: &str = "\
The merged image has the same bytes as a render in one piece, and the layers of the parts.

Examples:
  spherule merge picture.*.part -o picture.exr
  spherule merge picture.1-of-3.part picture.3-of-3.part --partial -o preview.png";

/// Help of `spherule status`.
pub(super) const STATUS: &str = "\
Exit codes: 0 complete and ready to merge, 1 a file cannot be used, 2 invalid command line, 3 incomplete

Examples:
  spherule status picture.*.part
  until spherule status picture.*.part; do sleep 60; done
  spherule status long.checkpoint --json";

/// Help of `spherule field`.
pub(super) const FIELD: &str = "\
Examples:
  spherule field -o field.toml               the scene of `spherule render`
  spherule field --count 500 --mix 1,0,0 --seed 7 -o large.toml
  spherule field grid --count 50 --radius 0.3 -o grid.toml
  spherule field lattice --jitter 0.03 -o crystal.toml";

/// Help of `spherule info`.
pub(super) const INFO: &str = "\
Examples:
  spherule info scene.toml
  spherule info particles.csv --json
  spherule info trajectory.xyz --frame last --rows 3";

/// Help of `spherule compare`.
pub(super) const COMPARE: &str = "\
Differences are in linear radiance. Exit code 0 means that the images could be compared, not that they
are equal.

Examples:
  spherule compare picture.exr reference.exr
  spherule compare a.png b.png --json";

/// Help of `spherule completions`.
pub(super) const COMPLETIONS: &str = "\
Examples:
  spherule completions bash > ~/.local/share/bash-completion/completions/spherule
  spherule completions zsh > ~/.zfunc/_spherule";
