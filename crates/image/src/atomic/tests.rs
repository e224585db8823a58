use super::*;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn new_and_old_files_get_the_content() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    for content in [&b"first, and longer"[..], b"second", b""] {
        write_atomically(&path, |file| file.write_all(content)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    assert_eq!(names(folder.path()), ["a"]);
}

#[test]
fn leftovers_of_killed_programs_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let long = "ä".repeat(110);
    for name in ["a.png", &long] {
        let path = folder.path().join(name);
        let left = temporary::named(&path, folder.path()).unwrap().keep().unwrap().1;
        fs::write(folder.path().join("other"), "").unwrap();
        temporary::named(&folder.path().join("a.pn"), folder.path()).unwrap().keep().unwrap();
        assert!(left.exists());
        remove_leftovers(&path).unwrap();
        assert!(!left.exists());
    }
    // Those of other files stay.
    assert_eq!(names(folder.path()).len(), 3);
}

#[test]
fn named_and_unnamed_files_replace_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let named = || temporary::named(&path, folder.path()).map(Temporary::Named);
    let usual = || Temporary::create(&path, folder.path());
    for (i, temporary) in [&usual as &dyn Fn() -> _, &usual, &named, &usual].iter().enumerate() {
        let (temporary, content) = (temporary().unwrap(), [i as u8]);
        temporary.file().write_all(&content).unwrap();
        temporary.persist(&path, folder.path()).unwrap();
        assert_eq!(fs::read(&path).unwrap(), content);
        assert_eq!(names(folder.path()), ["a"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn nothing_is_visible_before_all_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (path, there) in [("a", None), ("a", Some("a"))] {
        write_atomically(folder.path().join(path), |file| {
            file.write_all(b"content")?;
            file.flush()?;
            let seen: Vec<_> = there.into_iter().collect();
            // If the folder's file system has unnamed files.
            if matches!(Temporary::create(Path::new("a"), folder.path())?, Temporary::Unnamed(_)) {
                assert_eq!(names(folder.path()), seen);
            }
            Ok(())
        })
        .unwrap();
    }
}

#[test]
fn failures_leave_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let fail = |file: &mut dyn Write| {
        file.write_all(&[0; 10_000])?;
        Err(io::Error::other("out of ink"))
    };
    assert!(write_atomically(&path, fail).unwrap_err().to_string().contains("ink"));
    assert_eq!(names(folder.path()), [""; 0]);
    fs::write(&path, "old").unwrap();
    assert!(write_atomically(&path, fail).is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a"]);
}

#[test]
fn invalid_destinations_are_refused_before_writing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "old").unwrap();
    let missing = folder.path().join("missing").join("a");
    for path in [folder.path(), &missing, &file.join("a"), Path::new(""), Path::new("/")] {
        let refused = check_destination(path).unwrap_err().to_string();
        let called = |_: &mut dyn Write| panic!("must not be called");
        assert_eq!(write_atomically(path, called).unwrap_err().to_string(), refused);
    }
    assert!(check_destination(missing).unwrap_err().to_string().contains("create it first"));
    assert!(check_destination(&file).is_ok());
    assert!(check_destination(folder.path().join("new")).is_ok());
    assert_eq!(names(folder.path()), ["file"]);
    assert_eq!(fs::read(&file).unwrap(), b"old");
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_a_new_file_or_the_old_one() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    let (path, ordinary) = (folder.path().join("a"), folder.path().join("b"));
    fs::write(&ordinary, "").unwrap();
    write_atomically(&path, |file| file.write_all(b"1")).unwrap();
    assert_eq!(mode(&path), mode(&ordinary));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    write_atomically(&path, |file| file.write_all(b"2")).unwrap();
    assert_eq!(mode(&path) & 0o777, 0o640);
}

#[cfg(unix)]
#[test]
fn symbolic_links_stay_and_their_target_is_written() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("elsewhere")).unwrap();
    symlink("elsewhere/target", path("inner")).unwrap();
    symlink("inner", path("outer")).unwrap();
    for content in ["to nothing yet", "to a file"] {
        write_atomically(path("outer"), |file| file.write_all(content.as_bytes())).unwrap();
        assert!(path("outer").is_symlink() && path("inner").is_symlink());
        assert_eq!(fs::read(path("elsewhere/target")).unwrap(), content.as_bytes());
    }
    symlink("loop", path("loop")).unwrap();
    assert!(check_destination(path("loop")).is_err());
}

#[cfg(target_os = "linux")]
#[test]
fn unwritable_folders_are_detected() {
    // Not even the superuser can create a file here.
    let message = check_destination("/proc/a").unwrap_err().to_string();
    assert!(message.contains("\"/proc\"") && message.contains("another folder"), "{message}");
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_to_directly() {
    use std::os::unix::fs::FileTypeExt;
    let is_device = |path| fs::metadata(path).unwrap().file_type().is_char_device();
    let full = write_atomically("/dev/full", |file| file.write_all(b"1"));
    assert_eq!(full.unwrap_err().kind(), ErrorKind::StorageFull);
    assert!(is_device("/dev/full"));
    write_atomically("/dev/null", |file| file.write_all(b"1")).unwrap();
    assert!(is_device("/dev/null") && check_destination("/dev/null").is_ok());
}
