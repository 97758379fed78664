//! Structures from files that several scenes have in common: read once, reduced once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use nlmodes::linalg::Worker;
use nlmodes::model::check_mass;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes_io::{FeFiles, FeModel, NodeContact, ReadError};

use super::StructureError;
use crate::memory::{Limit, of_files};

/// Structures from files that were read and reduced, for scenes that share them.
///
/// The model of the files, and its open modes with the factorisation that they take, are kept as long as the files are
/// what they were and the latest ones fit into the limit; the very latest stays in any case. Gaps and stiffness of
/// stops, and all that a method says, may differ: modes do not depend on them, and what comes out is the same to the
/// last bit. Of several threads that want the same, one makes it and the others wait.
#[derive(Debug)]
pub struct Structures {
    limit: f64,
    models: Shelf<OfFiles, FeModel>,
    modes: Shelf<OfModes, OpenModes>,
}

impl Default for Structures {
    /// Keeps the latest structure alone.
    fn default() -> Self {
        Self { limit: 0.0, models: Shelf::default(), modes: Shelf::default() }
    }
}

impl Structures {
    /// Keeps as many of the latest structures as fit into the limit, by the estimate of what each takes.
    pub fn within(limit: Limit) -> Self {
        Self { limit: limit.bytes(), ..Self::default() }
    }

    /// The model of these files.
    ///
    /// # Errors
    /// [`StructureError::Read`].
    pub fn model(&self, files: &FeFiles) -> Result<Arc<FeModel>, StructureError> {
        self.models.get(OfFiles::now(files), (of_files(files), self.limit), || {
            let failed = |source: ReadError| StructureError::Read { key: key_of(files, &source.path), source };
            FeModel::read(files).map_err(failed)
        })
    }

    /// Open modes of the model with these contacts.
    ///
    /// # Errors
    /// [`StructureError`]: contacts that do not fit the model, a reduction that fails.
    pub fn modes(
        &self,
        files: &FeFiles,
        model: &FeModel,
        contacts: &[NodeContact],
        count: ModeCount,
    ) -> Result<OpenModes, StructureError> {
        let gaps: Vec<f64> = contacts.iter().map(|contact| contact.gap).collect();
        let compliance: Vec<f64> = contacts.iter().map(|contact| contact.stiffness.map_or(0.0, |k| 1.0 / k)).collect();
        let reduce = || {
            let (mass, stiffness) = (model.mass.symmetric()?, model.stiffness.symmetric()?);
            check_mass(&mass, &super::dofs(model)).map_err(StructureError::Mass)?;
            let directions = model.contact_directions(contacts)?;
            let (gaps, compliance) = (gaps.clone(), compliance.clone());
            let written = Some(model.written()?);
            let modes = OpenModes::known_to(mass, stiffness, directions, gaps, compliance, count, written)?;
            Ok::<_, StructureError>(modes)
        };
        let directions = contacts.iter().map(|contact| (contact.node, contact.against, contact.normal)).collect();
        let key = OfModes { files: OfFiles::now(files), directions, count };
        let known = self.modes.get(key, (of_files(files), self.limit), reduce)?;
        Ok(known.with_stops(gaps, compliance)?)
    }
}

/// The key below `structure` that names a file.
fn key_of(files: &FeFiles, path: &Path) -> &'static str {
    let optional = [("dofs", &files.dofs), ("mesh", &files.mesh)];
    let optional = optional.into_iter().filter_map(|(key, found)| Some((key, found.as_deref()?)));
    let all = [("mass", files.mass.path.as_path())].into_iter().chain(optional);
    // A matrix file may hold both.
    let is_stiffness = files.stiffness.path == path;
    all.filter(|_| !is_stiffness).find(|(_, found)| *found == path).map_or("stiffness", |(key, _)| key)
}

/// Files, with length and time of each.
#[derive(Debug, PartialEq)]
struct OfFiles {
    files: FeFiles,
    stamps: Vec<Option<(u64, SystemTime)>>,
}

impl OfFiles {
    fn now(files: &FeFiles) -> Self {
        let others = [&files.dofs, &files.mesh].into_iter().flatten().map(PathBuf::as_path);
        let all = [files.stiffness.path.as_path(), files.mass.path.as_path()].into_iter().chain(others);
        Self { files: files.clone(), stamps: all.map(stamp).collect() }
    }
}

fn stamp(path: &Path) -> Option<(u64, SystemTime)> {
    let data = fs::metadata(path).ok()?;
    Some((data.len(), data.modified().ok()?))
}

/// What open modes depend on.
#[derive(Debug, PartialEq)]
struct OfModes {
    files: OfFiles,
    /// Node, what it touches, and normal of each contact.
    directions: Vec<(u64, Option<u64>, [f64; 3])>,
    count: ModeCount,
}

/// Values that were made, the latest one last.
#[derive(Debug)]
struct Shelf<K, V>(Mutex<Vec<Place<K, V>>>);

#[derive(Debug)]
struct Place<K, V> {
    key: K,
    bytes: f64,
    value: Arc<Mutex<Option<Arc<V>>>>,
}

impl<K, V> Default for Shelf<K, V> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: PartialEq, V> Shelf<K, V> {
    /// The value of the key, made if it is not there; a failure is not kept.
    fn get<E>(&self, key: K, size: (f64, f64), make: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        let place = self.place(key, size);
        // A thread that panicked has left nothing half made.
        let mut value = Worker::idle(|| place.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some(known) = &*value {
            return Ok(Arc::clone(known));
        }
        let made = Arc::new(make()?);
        *value = Some(Arc::clone(&made));
        Ok(made)
    }

    /// Where the value of the key is or will be; what has not been asked for longest goes where all together are too
    /// large.
    fn place(&self, key: K, (bytes, limit): (f64, f64)) -> Arc<Mutex<Option<Arc<V>>>> {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let latest = match places.iter().position(|place| place.key == key) {
            Some(known) => places.remove(known),
            None => Place { key, bytes, value: Arc::default() },
        };
        let value = Arc::clone(&latest.value);
        places.push(latest);
        while places.len() > 1 && places.iter().map(|place| place.bytes).sum::<f64>() > limit {
            places.remove(0);
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use super::*;

    const STUDY: (f64, f64) = (1.0, 2.0);

    #[test]
    fn threads_that_want_the_same_have_it_made_once() {
        let (shelf, made) = (Shelf::default(), AtomicUsize::new(0));
        let make = || {
            thread::sleep(std::time::Duration::from_millis(20));
            Ok::<_, ()>(made.fetch_add(1, Ordering::Relaxed))
        };
        thread::scope(|scope| {
            let all: Vec<_> = (0..8).map(|_| scope.spawn(|| shelf.get("a", STUDY, make).unwrap())).collect();
            assert!(all.into_iter().all(|found| *found.join().unwrap() == 0));
        });
        assert_eq!(made.load(Ordering::Relaxed), 1);
    }

    #[test]
    fn the_longest_unused_goes_and_the_latest_stays() {
        let shelf = Shelf::default();
        let get = |key, size, value| *shelf.get(key, size, || Ok::<_, ()>(value)).unwrap();
        assert_eq!([get("a", STUDY, 1), get("b", STUDY, 2), get("a", STUDY, 3)], [1, 2, 1]);
        // The third one takes the place of b.
        assert_eq!([get("c", STUDY, 4), get("a", STUDY, 5), get("b", STUDY, 6)], [4, 1, 6]);
        let large = (3.0, 2.0);
        assert_eq!([get("d", large, 7), get("d", large, 8), get("a", STUDY, 9)], [7, 7, 9]);
    }

    #[test]
    fn what_failed_is_tried_again() {
        let shelf = Shelf::default();
        assert_eq!(shelf.get("a", STUDY, || Err::<i32, _>("no")), Err("no"));
        assert_eq!(shelf.get("a", STUDY, || Ok::<_, &str>(1)), Ok(Arc::new(1)));
    }
}
