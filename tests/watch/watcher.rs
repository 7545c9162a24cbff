//! Tests of file watching.

use std::fs;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use rayreel::live::{QUIET_PERIOD, Watcher, Watching};
use tempfile::TempDir;

use crate::{AT_MOST, LONG_ENOUGH};

/// A watcher of files in its own folder.
struct Watched {
    folder: TempDir,
    changes: Receiver<()>,
    watcher: Watcher,
}

impl Watched {
    fn new(watching: Watching, files: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            fs::write(folder.path().join(file), "first").unwrap();
        }
        let (sender, changes) = channel();
        let watcher = Watcher::start(watching, move || sender.send(()).unwrap());
        let watched = Self { folder, changes, watcher };
        watched.follow(files);
        watched
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    fn follow(&self, files: &[&str]) {
        let paths: Vec<PathBuf> = files.iter().map(|file| self.path(file)).collect();
        // The files count as read before.
        self.watcher.follow(&paths, SystemTime::now() + LONG_ENOUGH);
    }

    fn write(&self, file: &str, text: &str) {
        fs::write(self.path(file), text).unwrap();
    }

    /// Checks that a save is noticed once. A save that a busy machine made in pieces may be noticed in pieces.
    fn notices(&self, what: &str, save: impl FnOnce()) {
        let start = Instant::now();
        save();
        let in_pieces = start.elapsed() > QUIET_PERIOD / 2;
        assert!(self.changes.recv_timeout(AT_MOST).is_ok(), "{what}: nothing was noticed");
        let again = self.changes.recv_timeout(LONG_ENOUGH).is_ok();
        assert!(!again || in_pieces, "{what}: noticed twice");
    }

    fn does_not_change(&self, what: &str) {
        assert!(self.changes.recv_timeout(LONG_ENOUGH).is_err(), "{what}: noticed");
    }
}

/// Checks every way in which editors save a file.
fn save_in_every_way(watched: &Watched) {
    let file = "ball.ron";
    watched.notices("written in place", || watched.write(file, "in place"));

    watched.notices("written and renamed", || {
        watched.write(".ball.ron.new", "renamed");
        fs::rename(watched.path(".ball.ron.new"), watched.path(file)).unwrap();
    });

    watched.notices("moved away and written", || {
        fs::rename(watched.path(file), watched.path("ball.ron~")).unwrap();
        watched.write(file, "with a backup");
    });

    watched.notices("deleted and created", || {
        fs::remove_file(watched.path(file)).unwrap();
        watched.write(file, "created");
    });

    watched.notices("two quick saves", || {
        watched.write(file, "one");
        watched.write(file, "two");
    });

    // The length and the modification time stay the same.
    watched.notices("with the time of the old one", || {
        let time = fs::metadata(watched.path(file)).unwrap().modified().unwrap();
        watched.write(".ball.ron.new", "six");
        fs::File::options()
            .append(true)
            .open(watched.path(".ball.ron.new"))
            .unwrap()
            .set_modified(time)
            .unwrap();
        fs::rename(watched.path(".ball.ron.new"), watched.path(file)).unwrap();
    });
}

#[test]
fn every_save_method_is_noticed_once() {
    save_in_every_way(&Watched::new(Watching::Events, &["ball.ron", "part.ron"]));
}

#[test]
fn polling_notices_the_same() {
    let watched = Watched::new(Watching::Polling, &["ball.ron", "part.ron"]);
    save_in_every_way(&watched);
    watched.notices("deleted", || fs::remove_file(watched.path("part.ron")).unwrap());
}

#[test]
fn saves_without_changes_are_not_noticed() {
    let watched = Watched::new(Watching::Events, &["ball.ron"]);
    watched.write("ball.ron", "first");
    watched.does_not_change("the same text");
    watched.write("other.ron", "other");
    watched.does_not_change("another file");
    fs::read(watched.path("ball.ron")).unwrap();
    watched.does_not_change("a reader");
    watched.write(".ball.ron.new", "first");
    fs::rename(watched.path(".ball.ron.new"), watched.path("ball.ron")).unwrap();
    watched.does_not_change("the same text in another file");
}

#[test]
fn followed_files_may_be_added_removed_and_recreated() {
    let watched = Watched::new(Watching::Events, &["ball.ron"]);
    fs::create_dir(watched.path("parts")).unwrap();
    watched.write("parts/wheel.ron", "first");
    watched.follow(&["ball.ron", "parts/wheel.ron", "parts/none.ron"]);
    watched.does_not_change("following");
    watched.notices("a file that joined", || watched.write("parts/wheel.ron", "second"));
    watched.notices("a file that was not there", || watched.write("parts/none.ron", "first"));
    watched.notices("a folder that goes", || fs::remove_dir_all(watched.path("parts")).unwrap());
    watched.notices("a folder that comes back", || {
        fs::create_dir(watched.path("parts")).unwrap();
        watched.write("parts/wheel.ron", "third");
    });
    watched.notices("a file in a folder that came back", || watched.write("parts/wheel.ron", "fourth"));
    watched.follow(&["ball.ron"]);
    watched.write("parts/wheel.ron", "fifth");
    watched.does_not_change("a file that left");
}

#[test]
fn writes_during_reading_are_noticed() {
    let watched = Watched::new(Watching::Events, &["ball.ron"]);
    let follow =
        |file: &str, since| watched.watcher.follow(&[watched.path("ball.ron"), watched.path(file)], since);
    let since = SystemTime::now();
    sleep(Duration::from_millis(50));
    watched.watcher.check();
    follow("ball.ron", since);
    watched.does_not_change("what was there before");
    sleep(Duration::from_millis(50));
    watched.notices("a file that joins, written after the reading began", || {
        watched.write("part.ron", "first");
        follow("part.ron", since);
    });
    // A change that is read before the watcher reports it need not be reported.
    watched.write("ball.ron", "second");
    watched.watcher.check();
    follow("part.ron", SystemTime::now());
    watched.does_not_change("what was looked at");
    // For a moment, when the file was read, it had other contents.
    watched.notices("what is as it was before", || {
        watched.write("ball.ron", "third");
        watched.write("ball.ron", "second");
        follow("part.ron", SystemTime::now());
    });
}

#[cfg(unix)]
#[test]
fn links_are_followed() {
    use std::os::unix::fs::symlink;
    let watched = Watched::new(Watching::Events, &[]);
    for folder in ["one", "two"] {
        fs::create_dir(watched.path(folder)).unwrap();
        watched.write(&format!("{folder}/ball.ron"), folder);
    }
    symlink(watched.path("one"), watched.path("now")).unwrap();
    symlink("now/ball.ron", watched.path("link.ron")).unwrap();
    watched.follow(&["link.ron"]);
    watched.notices("what a link leads to", || watched.write("one/ball.ron", "edited"));
    watched.notices("a link to a folder that leads elsewhere", || {
        symlink(watched.path("two"), watched.path("next")).unwrap();
        fs::rename(watched.path("next"), watched.path("now")).unwrap();
    });
    watched.notices("where it leads now", || watched.write("two/ball.ron", "edited too"));
}

#[test]
fn a_save_in_quick_parts_is_noticed_once() {
    let watched = Watched::new(Watching::Events, &["ball.ron"]);
    watched.notices("five writes in a row", || {
        for part in 0..5 {
            watched.write("ball.ron", &"part ".repeat(part + 2));
            sleep(QUIET_PERIOD / 25);
        }
    });
}
