//! Spherule compiled for other processor levels: each a process of this program that measures when told.
//!
//! Programs for several levels cannot be one, so each runs beside this one with the same scenes and rays, one
//! at a time. Lines of text go to it and come back; what it says of rays and answers is compared with this
//! program's own, to the bit.

use crate::contest::{Answers, spherule};
use crate::options::Options;
use crate::rays::{Class, Order, Rays, Seen};
use crate::scenes::Columns;
use clap::ValueEnum;
use spherule_core::SphereTree;
use spherule_measure::workload::SphereScene;
use std::error::Error;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{BufRead, BufReader, Write, stdin, stdout};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::str::FromStr;

/// A name and this program, compiled for that level: `v3=PATH`.
#[derive(Clone, Debug)]
pub struct Program {
    pub level: String,
    path: PathBuf,
}

impl FromStr for Program {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (level, path) = text.split_once('=').ok_or("give a level and a file, as v3=PROGRAM")?;
        Ok(Self { level: level.to_owned(), path: path.into() })
    }
}

/// A running program for a level.
pub struct Runner {
    pub level: String,
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Runner {
    /// Starts a program with the same picture.
    ///
    /// # Errors
    /// It cannot be started.
    pub fn start(program: &Program, options: &Options) -> Result<Self, Box<dyn Error>> {
        let mut command = Command::new(&program.path);
        command.args(["--serve", "--embree", "none", "--side", &options.side.to_string()]);
        command.args(options.hits_only.then_some("--hits-only"));
        let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let failed = |error| format!("{} cannot be started: {error}", program.path.display());
        let mut child = child.map_err(failed)?;
        let (input, output) = child.stdin.take().zip(child.stdout.take()).ok_or("no pipes")?;
        Ok(Self { level: program.level.clone(), child, input, output: BufReader::new(output) })
    }

    fn ask(&mut self, line: &str) -> Result<String, Box<dyn Error>> {
        writeln!(self.input, "{line}")?;
        let mut answer = String::new();
        self.output.read_line(&mut answer)?;
        if answer.is_empty() {
            return Err(format!("the program for {} has ended", self.level).into());
        }
        Ok(answer.trim_end().to_owned())
    }

    /// Builds a scene.
    ///
    /// # Errors
    /// The program has ended.
    pub fn load(&mut self, scene: SphereScene) -> Result<(), Box<dyn Error>> {
        self.ask(&format!("scene {}", scene.name)).map(drop)
    }

    /// Makes the rays of a class, and checks that they are these.
    ///
    /// # Errors
    /// The program has ended, or has other rays.
    pub fn make_rays(
        &mut self,
        class: Class,
        order: Order,
        rays: &Rays,
    ) -> Result<(), Box<dyn Error>> {
        let theirs = self.ask(&format!("rays {} {}", class.name(), order.name()))?;
        if theirs == hash_of_rays(rays).to_string() { Ok(()) } else { Err(self.differs("rays")) }
    }

    /// Returns the seconds that the rays take, and checks that the answers are these.
    ///
    /// # Errors
    /// The program has ended, or has other answers.
    pub fn run(&mut self, class: Class, answers: &Answers) -> Result<f64, Box<dyn Error>> {
        let line = self.ask("run")?;
        let (seconds, hash) = line.split_once(' ').ok_or("no answer")?;
        if hash == hash_of_answers(class, answers).to_string() {
            Ok(seconds.parse()?)
        } else {
            Err(self.differs("answers"))
        }
    }

    fn differs(&self, what: &str) -> Box<dyn Error> {
        format!("the program for {} has other {what}", self.level).into()
    }
}

/// Ends the program.
impl Drop for Runner {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn hash_of_rays(rays: &Rays) -> u64 {
    let mut hasher = DefaultHasher::new();
    for i in 0..rays.len() {
        let (origin, direction) = rays.row(i);
        (origin.to_array().map(f32::to_bits), direction.to_array().map(f32::to_bits))
            .hash(&mut hasher);
    }
    hasher.finish()
}

fn hash_of_answers(class: Class, answers: &Answers) -> u64 {
    let mut hasher = DefaultHasher::new();
    if class.is_any() {
        answers.occluded.hash(&mut hasher);
    } else {
        answers.spheres.hash(&mut hasher);
        answers.spherule_t.iter().for_each(|t| t.to_bits().hash(&mut hasher));
    }
    hasher.finish()
}

/// The tree and the rays of a program that serves.
struct Served {
    tree: SphereTree,
    spheres: Columns,
    flat: bool,
    seen: Option<(Order, Seen)>,
    class: Class,
    rays: Rays,
}

/// Does what the lines of standard input say.
///
/// # Errors
/// A line that no [`Runner`] writes, or a scene that does not fit the memory.
pub fn serve(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut served: Option<Served> = None;
    for line in stdin().lines() {
        let line = line?;
        let answer = match (line.split_once(' ').unwrap_or((&line, "")), &mut served) {
            (("scene", of), before) => {
                // Its memory is free before the next scene is built.
                drop(before.take());
                let scene = SphereScene::named(of).ok_or("an unknown scene")?;
                let spheres = Columns::of(scene)?;
                let Columns { x, y, z, radius } = &spheres;
                let tree = SphereTree::from_columns(x, y, z, radius)?;
                let (flat, class, rays) = (scene.flat, Class::Primary, Rays::default());
                served = Some(Served { tree, spheres, flat, seen: None, class, rays });
                "ready".to_owned()
            }
            (("rays", of), Some(served)) => {
                let (class, order) = of.split_once(' ').ok_or("no order")?;
                let order = Order::from_str(order, true)?;
                if served.seen.as_ref().is_none_or(|(of, _)| *of != order) {
                    let side = options.side.next_multiple_of(4);
                    let Served { flat, spheres, tree, .. } = &*served;
                    let seen = Seen::new(*flat, spheres, tree, side, order)?;
                    served.seen = Some((order, seen));
                }
                served.class = Class::from_str(class, true)?;
                let rays = served.seen.as_ref().map(|(_, seen)| seen.rays(served.class, order));
                served.rays = rays.ok_or("no picture")?.into_owned();
                hash_of_rays(&served.rays).to_string()
            }
            (("run", _), Some(Served { tree, class, rays, .. })) => {
                let mut answers = Answers::new(rays.len());
                let (seconds, _) = spherule(tree, *class, rays, options.hits_only, &mut answers)?;
                format!("{seconds:e} {}", hash_of_answers(*class, &answers))
            }
            _ => return Err(format!("cannot do `{line}`").into()),
        };
        writeln!(stdout(), "{answer}")?;
    }
    Ok(())
}
