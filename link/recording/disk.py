"""What has to be on a disk, and not only on its way there."""

import errno
import os


def sync(descriptor: int) -> None:
    """Have what was written to an open file on the disk itself, where a power failure leaves it.

    Raises:
        OSError: it is not there, or the file was deleted: what goes into it is in no folder any more.
    """
    os.fdatasync(descriptor)
    if os.fstat(descriptor).st_nlink == 0:
        raise FileNotFoundError(errno.ENOENT, "the file was deleted")
