"""Point clouds: reading and writing the files that people have."""

from jaxpaint.clouds.files import Cloud, read_cloud, write_ply

__all__ = ["Cloud", "read_cloud", "write_ply"]
