//! Two folders that change their names at once.

use std::io;
use std::path::Path;

/// Exchanges the names of two folders of one file system, in one operation. The second keeps its permissions.
///
/// # Errors
/// The system or the file system cannot do that; nothing has changed.
pub(super) fn folders(new: &Path, old: &Path) -> io::Result<()> {
    #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        std::fs::set_permissions(new, std::fs::metadata(old)?.permissions())?;
        Ok(renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE)?)
    }
    #[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
    {
        let _ = (new, old);
        Err(io::ErrorKind::Unsupported.into())
    }
}
