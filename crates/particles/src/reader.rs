//! Reads the frames of a file, one after another.

use crate::source::{Source, is_standard_input};
use crate::{
    AlignBy, BondSource, Element, ElementSource, FileError, Format, FrameChoice, ParticleFrame,
    ReadOptions, Role,
    derived::Derived,
    formats,
    frame_reader::FrameReader,
    ids,
    place::{FrameIndex, Mark, Place},
    shapes::ShapeColumns,
    smoothing::Window,
    sniff,
    superposition::Reference,
    topology::Joined,
    trails::History,
};
use std::path::{Path, PathBuf};

/// The frames of a file of particles, read one at a time. After an error there are no more.
pub struct Frames {
    reader: Box<dyn FrameReader>,
    path: PathBuf,
    /// Elements of types that are given.
    elements: Vec<(String, Element)>,
    bonds: BondSource,
    /// The source that is asked for: columns and whole molecules may need bonds of others.
    wanted_bonds: BondSource,
    whole: bool,
    derived: Vec<Derived>,
    shapes: ShapeColumns,
    smoothing: Option<Window>,
    trails: Option<History>,
    /// Options with which the first frame is read, and it itself once it is needed.
    align: Option<Alignment>,
    /// Number of frames around each one that are averaged with it or in its trails.
    around: u64,
    /// Places of frames, if they are noted.
    index: Option<FrameIndex>,
    /// Number of frames that were read or skipped.
    passed: u64,
    failed: bool,
}

/// The first frame, on which others are superposed.
struct Alignment {
    by: AlignBy,
    options: ReadOptions,
    reference: Option<Reference>,
}

impl Frames {
    /// Opens a file, or standard input for the path `-`. [`ReadOptions::frame`] is ignored.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or its format is unknown.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, FileError> {
        let (derived, mut inner) = Derived::take(options);
        if options.whole {
            inner.bonds = inner.bonds.for_all();
        }
        if let Some(align) = &options.align {
            inner.columns.wanted.extend_from_slice(align.columns());
        }
        let columns = inner.columns.clone();
        if options.smooth > 0 || options.trail > 0 {
            // Rows of LAMMPS files are sorted by them.
            inner.columns.wanted.push(ids::ID.to_owned());
        }
        let shapes = ShapeColumns::ask(&mut inner);
        let reader: Box<dyn FrameReader> = match &inner.topology {
            None => open_positions(path, &inner)?.1,
            Some(topology) => Box::new(Joined::new(path, topology, &inner)?),
        };
        Ok(Self {
            reader,
            path: path.to_owned(),
            elements: inner.elements,
            bonds: inner.bonds,
            wanted_bonds: options.bonds.clone(),
            whole: options.whole,
            derived,
            shapes,
            smoothing: (options.smooth > 0).then(|| Window::new(options.smooth)),
            trails: (options.trail > 0).then(|| History::new(options.trail)),
            align: options.align.clone().map(|by| Alignment {
                by,
                options: ReadOptions { align: None, trail: 0, columns, ..options.clone() },
                reference: None,
            }),
            around: u64::from(options.smooth) + u64::from(options.trail),
            index: None,
            passed: 0,
            failed: false,
        })
    }

    /// Takes the index of the file, to which it adds the places of frames that are passed.
    pub(crate) fn with_index(self, index: &FrameIndex) -> Self {
        let own = Self { index: Some(index.clone()), ..self };
        own.note();
        own
    }

    /// Notes where the next frame begins, unless frames after it have been read.
    fn note(&self) {
        if self.smoothing.is_none()
            && let Some(index) = &self.index
            && let Some(place) = self.reader.place()
        {
            index.note(self.passed, place);
        }
    }

    /// Returns the last known place that is not after this frame.
    fn mark(&self, frame: u64) -> Option<Mark> {
        self.index.as_ref()?.before(frame)
    }

    /// Returns whether [`Self::go_to`] finds this frame, though it may have been passed.
    pub(crate) fn reaches(&self, frame: u64) -> bool {
        let goes_back = || self.reader.place().is_some() && self.mark(frame).is_some();
        !self.failed
            && (self.around == 0 || self.passed == 0)
            && (self.passed <= frame || goes_back())
    }

    /// Passes the frames before this one with as little work as the format allows, but reads those that are averaged with it,
    /// or in its trails; fewer if there are not so many.
    fn go_to(&mut self, frame: u64) -> Result<(), FileError> {
        let passes = self.around == 0 || self.passed == 0;
        let first = if passes { frame.saturating_sub(self.around) } else { 0 };
        if let Some(mark) = self.mark(first)
            && (self.passed > frame || self.passed < mark.frame)
            && self.reader.start_at(&mark.place)?
        {
            self.passed = mark.frame;
        }
        while self.passed < frame {
            let passed = if self.passed < first { self.pass_frame() } else { self.skip_frame() };
            if !passed? {
                break;
            }
        }
        Ok(())
    }

    /// Reads this frame, which [`Self::reaches`].
    pub(crate) fn read_at(&mut self, frame: u64) -> Result<ParticleFrame, FileError> {
        self.go_to(frame)?;
        let found = if self.passed == frame { self.next().transpose()? } else { None };
        found.ok_or_else(|| match self.passed {
            0 if frame == 0 => FileError::whole_file(&self.path, "holds no particles"),
            count => {
                let message = format!("has no frame {frame}, only {count} (the first is 0)");
                FileError::whole_file(&self.path, message)
            }
        })
    }

    /// Passes all complete frames, and returns their number.
    pub(crate) fn pass_all(&mut self) -> Result<u64, FileError> {
        if let Some(mark) = self.mark(u64::MAX)
            && self.passed < mark.frame
            && self.reader.start_at(&mark.place)?
        {
            self.passed = mark.frame;
        }
        while self.pass_frame()? {}
        Ok(self.passed)
    }

    /// Returns the next frame with its bonds, and with warnings about columns that are not drawn.
    fn next_frame(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let next = match &mut self.smoothing {
            Some(window) => window.next(&mut *self.reader)?,
            None => self.reader.next()?,
        };
        let Some(mut frame) = next else { return Ok(None) };
        if self.trails.is_some() && self.smoothing.is_none() {
            ids::sort(&mut frame);
        }
        if frame.format.lacks_names() && frame.kinds.codes.is_empty() && !frame.is_empty() {
            let warning =
                "its particles have no names; --topology FILE reads them from another file";
            frame.warnings.push(warning.to_owned());
        }
        for kind in &mut frame.kinds.table {
            let given = self.elements.iter().rev().find(|(name, _)| *name == kind.name);
            if let Some((_, element)) = given {
                (kind.element, kind.source) = (Some(*element), ElementSource::Given);
            }
        }
        let fault = |message: String| FileError::whole_file(&self.path, message);
        self.shapes.apply(&mut frame).map_err(fault)?;
        frame.find_bonds(&self.bonds).map_err(fault)?;
        for column in &self.derived {
            column.add(&mut frame).map_err(fault)?;
        }
        if let Some(window) = &mut self.smoothing {
            window.smooth(&self.path, &mut frame)?;
            window.advance();
        }
        if self.whole {
            if frame.bonds.is_none() && !frame.is_empty() {
                let message =
                    "has neither bonds nor elements by which molecules could be made whole";
                let help = "give a --topology with bonds or elements";
                return Err(fault(message.to_owned()).with_help(help));
            }
            frame.make_whole();
        }
        if let Some(alignment) = &mut self.align {
            alignment.apply(&self.path, self.passed == 0, &mut frame)?;
        }
        if let Some(history) = &mut self.trails {
            history.add(&self.path, &mut frame)?;
        }
        self.passed += 1;
        self.note();
        let has_bonds = match self.wanted_bonds {
            BondSource::None => false,
            BondSource::OfCrystals => frame.is_crystal(),
            BondSource::Auto | BondSource::File | BondSource::Rules(_) => true,
        };
        frame.bonds = frame.bonds.filter(|_| has_bonds);
        Ok(Some(frame))
    }

    /// Passes the frames before this one to `look`, until it returns true.
    fn look_at(&mut self, index: u64, look: Look) -> Result<(), FileError> {
        for _ in 0..index {
            let Some(frame) = self.next().transpose()? else { break };
            if look(frame)? {
                break;
            }
        }
        Ok(())
    }

    /// Returns the number of frames that were read or skipped.
    pub(crate) fn passed(&self) -> u64 {
        self.passed
    }

    /// Returns whether another frame seems to follow.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn more(&mut self) -> Result<bool, FileError> {
        let is_ahead = self.smoothing.as_ref().is_some_and(Window::has_next);
        Ok(!self.failed && (is_ahead || self.reader.more()?))
    }

    /// Skips the next frame of the file, which isn't averaged with later ones.
    fn pass_frame(&mut self) -> Result<bool, FileError> {
        let skipped = self.reader.skip()?;
        if skipped {
            self.passed += 1;
            self.note();
        }
        Ok(skipped)
    }

    /// Skips the next frame with as little work as the format allows. Returns whether there was one.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or the part that was parsed is malformed.
    pub fn skip_frame(&mut self) -> Result<bool, FileError> {
        if self.trails.is_some() && !self.failed {
            let frame = self.next_frame();
            self.failed = frame.is_err();
            return frame.map(|frame| frame.is_some());
        }
        let skipped = match &mut self.smoothing {
            _ if self.failed => Ok(false),
            Some(window) => window.next(&mut *self.reader).map(|frame| {
                window.advance();
                frame.is_some()
            }),
            None => self.reader.skip(),
        };
        self.failed |= skipped.is_err();
        if let Ok(true) = skipped {
            self.passed += 1;
            self.note();
        }
        skipped
    }
}

impl Alignment {
    /// Superposes a frame on the first one of the file.
    fn apply(
        &mut self,
        path: &Path,
        is_first: bool,
        frame: &mut ParticleFrame,
    ) -> Result<(), FileError> {
        let fault = |message: String| FileError::whole_file(path, message);
        let reference = match &mut self.reference {
            Some(reference) => reference,
            none if is_first => {
                *none = Some(Reference::new(frame, &self.by).map_err(fault)?);
                return Ok(());
            }
            _ if is_standard_input(path) => {
                let help = "write it to a file";
                let message =
                    "frames are aligned to the first one, which standard input has only once";
                return Err(fault(message.to_owned()).with_help(help));
            }
            none => {
                let first = ReadOptions { frame: FrameChoice::Index(0), ..self.options.clone() };
                let first = read_frame(path, &first)?;
                none.insert(Reference::new(&first, &self.by).map_err(fault)?)
            }
        };
        reference.align(frame).map_err(fault)
    }
}

/// Returns the reader of a file of positions, without its topology, and its format.
pub(crate) fn open_positions(
    path: &Path,
    options: &ReadOptions,
) -> Result<(Format, Box<dyn FrameReader>), FileError> {
    let (format, reader) = open(path, options)?;
    if format.lacks_positions() {
        let error = FileError::whole_file(path, "is a topology, without positions");
        let name = path.display();
        return Err(error.with_help(format!("name a trajectory, and give it --topology {name}")));
    }
    Ok((format, reader))
}

/// Returns the reader of a file and its format; a topology may lack positions.
pub(crate) fn open(
    path: &Path,
    options: &ReadOptions,
) -> Result<(Format, Box<dyn FrameReader>), FileError> {
    let mut source = Source::open(path, &options.progress)?;
    let format = sniff::format(&mut source, options)?;
    let is_other = |(role, name): &&(Role, String)| {
        [Role::X, Role::Y, Role::Z].contains(role) && !name.eq_ignore_ascii_case(role.name())
    };
    if format.fixes_positions()
        && let Some((role, name)) = options.columns.roles.iter().find(is_other)
    {
        let (role, format) = (role.name(), format.name());
        let message =
            format!("`{role}={name}` has no effect: positions of {format} are x, y and z");
        let error = FileError::whole_file(path, message);
        return Err(error.with_help("leave x, y and z out of --columns"));
    }
    let bonds = options.bonds.for_format(format);
    let reader = (formats::row(format).open)(source, &ReadOptions { bonds, ..options.clone() })?;
    Ok((format, Box::new(WithVolume(reader))))
}

/// Reader whose frames have no cell without a volume: such a cell is left out with a warning.
struct WithVolume(Box<dyn FrameReader>);

impl FrameReader for WithVolume {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(mut frame) = self.0.next()? else { return Ok(None) };
        if let Some(cell) = frame.cell.take_if(|cell| cell.with_volume().is_none()) {
            let [a, b, c] = cell.vectors.map(|edge| edge.to_array());
            frame.warnings.push(if cell.vectors.iter().any(|edge| edge.is_nan()) {
                "its cell is left out: no cell has such angles".to_owned()
            } else {
                format!("its cell is left out: edges {a:?}, {b:?} and {c:?} have no volume")
            });
        }
        Ok(Some(frame))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        self.0.skip()
    }

    fn more(&mut self) -> Result<bool, FileError> {
        self.0.more()
    }

    fn place(&self) -> Option<Place> {
        self.0.place()
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.0.start_at(place)
    }
}

impl Iterator for Frames {
    type Item = Result<ParticleFrame, FileError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let frame = self.next_frame();
        self.failed = frame.is_err();
        frame.transpose()
    }
}

/// Reads the frame that the options select, unmodified: nothing is scaled or dropped. Earlier frames
/// are skipped with little work. For the last frame, a file is opened twice, and a truncated frame is
/// not counted.
///
/// # Errors
///
/// The file cannot be read, is truncated, has no such frame, or is malformed: the error names the
/// line and the column.
pub fn read_frame(path: &Path, options: &ReadOptions) -> Result<ParticleFrame, FileError> {
    Ok(read_after(path, options, None)?.0)
}

/// Takes a frame, and returns whether no later one is wanted.
type Look<'a> = &'a mut dyn FnMut(ParticleFrame) -> Result<bool, FileError>;

/// Reads the frame that the options select as [`read_frame`]; before, the frames from the first one on are passed to `look`
/// until it returns true, or the selected frame is next. Also returns whether the file has several frames.
///
/// A first frame that cannot be read is passed over, except where the input can be read only once.
///
/// # Errors
///
/// Those of [`read_frame`], and those of `look`.
pub fn read_frame_after(
    path: &Path,
    options: &ReadOptions,
    look: &mut dyn FnMut(ParticleFrame) -> Result<bool, FileError>,
) -> Result<(ParticleFrame, bool), FileError> {
    read_after(path, options, Some(look))
}

fn read_after(
    path: &Path,
    options: &ReadOptions,
    look: Option<Look>,
) -> Result<(ParticleFrame, bool), FileError> {
    let places = FrameIndex::default();
    let index = match options.frame {
        FrameChoice::Index(index) => index,
        FrameChoice::Last if is_standard_input(path) => return last_of_stream(path, options, look),
        FrameChoice::Last => {
            Frames::open(path, options)?.with_index(&places).pass_all()?.saturating_sub(1)
        }
    };
    let mut frames = Frames::open(path, options)?.with_index(&places);
    if let Some(look) = look.filter(|_| index > 0) {
        if is_standard_input(path) || !path.is_file() {
            frames.look_at(index, look)?;
        } else if let Ok(mut first) = Frames::open(path, options) {
            first
                .look_at(index, look)
                .or_else(|error| if first.failed { Ok(()) } else { Err(error) })?;
        }
    }
    let mut frame = frames.read_at(index)?;
    let has_several = index > 0 || frames.more()?;
    if options.frame == FrameChoice::default() && has_several {
        frame
            .warnings
            .push("only the first of several frames is read; --frame chooses others".to_owned());
    }
    Ok((frame, has_several))
}

/// Returns the last frame of a stream, which can be read only once, and whether it has several.
fn last_of_stream(
    path: &Path,
    options: &ReadOptions,
    mut look: Option<Look>,
) -> Result<(ParticleFrame, bool), FileError> {
    let (mut last, mut has_several) = (None, false);
    for frame in Frames::open(path, options)? {
        if let Some(before) = last.replace(frame?) {
            has_several = true;
            if let Some(wanted) = &mut look
                && wanted(before)?
            {
                look = None;
            }
        }
    }
    let last = last.ok_or_else(|| FileError::whole_file(path, "holds no particles"))?;
    Ok((last, has_several))
}

/// Number of frames in a file, counted with as little work as the format allows.
#[derive(Clone, Debug)]
pub struct FrameCount {
    /// Number of complete frames, up to the maximum that was asked for.
    pub whole: u64,
    /// Error after these frames; `None` if the file ends there. Skipping may miss a truncated last frame;
    /// reading it reports the error.
    pub rest: Option<FileError>,
}

impl FrameCount {
    /// Counts the frames of a file, at most `most` of them.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or its format is unknown.
    pub fn of(path: &Path, options: &ReadOptions, most: u64) -> Result<Self, FileError> {
        let mut frames = Frames::open(path, &ReadOptions { trail: 0, ..options.clone() })?;
        let mut whole = 0;
        while whole < most {
            match frames.skip_frame() {
                Ok(true) => whole += 1,
                Ok(false) => break,
                Err(error) => return Ok(Self { whole, rest: Some(error) }),
            }
        }
        Ok(Self { whole, rest: None })
    }
}

/// Returns the number of complete frames in a file.
///
/// # Errors
///
/// The file cannot be read, or its format is unknown.
pub fn count_frames(path: &Path, options: &ReadOptions) -> Result<u64, FileError> {
    Frames::open(path, options)?.pass_all()
}
