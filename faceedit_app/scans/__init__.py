"""Characters made of scans: landmarks found on pictures of them, and the steps of making one."""
