//! What `--help` ends with.

/// Of the program.
pub(super) const PROGRAM: &str = "\
Examples:
  spherule                                   a random field of spheres, to spherule.png
  spherule particles.xyz -o figure.png       the same as spherule render particles.xyz ...
  spherule ./info                            a file that is named like a command
  spherule render scenes/weekend.toml -o weekend.png
  spherule info scenes/weekend.toml

Exit codes: 0 done, 1 failed, 2 command line not understood, 130 interrupted,
143 terminated";

/// Of `spherule render`.
pub(super) const RENDER: &str = "\
Examples:
  spherule render                            a random field of spheres, to spherule.png
  spherule render scene.toml -o picture.exr --size 1920x1080 --spp 256
  spherule render scene.toml --until-error 1%       as many samples as that takes
  spherule render particles.xyz -o figure.png --integrator ao
  spherule render run.lammpstrj.gz --frame last --radii 0.5 -o last.png
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png
  spherule render run.lammpstrj.gz --frame all --turntable 360 --fps 24 -o film.mp4
  spherule render run.lammpstrj.gz --frame all -o frame-%04d.png --skip-existing --part 2/4
  spherule render run.dump --color-by c_pe --color-map inferno --color-bar energy.svg
  spherule render protein.pdb --select 'element != H and chain == A' -o chain.png
  spherule render salt.xyz --type Na:radius=1,material=glass --type Cl:color=#30a030
  spherule render crystal.cif --wrap --replicate 3,3,2 --cell --view auto -o crystal.png
  spherule render protein.pdb --projection orthographic --turntable 90 -o turn.png
  spherule render protein.pdb --preset outline --background white -o outline.png
  spherule render grains.data --slice 'z>50%' --slice-mode caps -o section.png
  spherule render scene.toml -o - --output-format jpeg | display
  spherule render scene.toml --region 100,50,64x64 -o detail.png
  spherule render scene.toml -o picture.exr --part 3/8     to picture.3-of-8.part, for merge
  spherule render scene.toml -o picture.exr --part from-env     in a job array or under mpirun
  spherule render scene.toml --prepare scene.prepared     for parts to begin at once: render that file
  parallel spherule render scene.toml -o picture.exr --part {}/8 ::: $(seq 8)
  spherule render scene.toml -o picture.exr --layers albedo,normal,depth,id
  spherule render scene.toml --memory-limit 4GB     refused at once if it would take more
  spherule render scene.toml --json --quiet > statistics.json
  spherule render scene.toml --spp 100000 -o long.exr --checkpoint long.checkpoint
  spherule render --resume long.checkpoint          to the same picture as if it had never stopped
  spherule render --resume long.checkpoint --spp 200000 --threads 8

Ctrl-C and SIGTERM save the picture so far, and the checkpoint, and exit with code 130 and 143. A
second one ends the program at once; files are whole then too. Of a sequence, a picture that is
interrupted is not written, but the checkpoint is.";

/// Of `spherule merge`.
pub(super) const MERGE: &str = "\
The picture has the bytes of one that was rendered as a whole, and the layers of the parts.

Examples:
  spherule merge picture.*.part -o picture.exr
  spherule merge picture.1-of-3.part picture.3-of-3.part --partial -o preview.png";

/// Of `spherule status`.
pub(super) const STATUS: &str = "\
Exit codes: 0 all is there and can be merged, 3 something is still to be rendered, 1 a file is of no
use, 2 command line not understood

Examples:
  spherule status picture.*.part
  until spherule status picture.*.part; do sleep 60; done
  spherule status long.checkpoint --json";

/// Of `spherule field`.
pub(super) const FIELD: &str = "\
Examples:
  spherule field -o field.toml               the scene of `spherule render`
  spherule field --count 500 --mix 1,0,0 --seed 7 -o large.toml
  spherule field grid --count 50 --radius 0.3 -o grid.toml
  spherule field lattice --jitter 0.03 -o crystal.toml";

/// Of `spherule info`.
pub(super) const INFO: &str = "\
Examples:
  spherule info scene.toml
  spherule info particles.csv --json
  spherule info trajectory.xyz --frame last --rows 3";

/// Of `spherule compare`.
pub(super) const COMPARE: &str = "\
Differences are in linear radiance. Exit code 0 says that the pictures could be compared, not that
they are equal.

Examples:
  spherule compare picture.exr reference.exr
  spherule compare a.png b.png --json";

/// Of `spherule completions`.
pub(super) const COMPLETIONS: &str = "\
Examples:
  spherule completions bash > ~/.local/share/bash-completion/completions/spherule
  spherule completions zsh > ~/.zfunc/_spherule";
