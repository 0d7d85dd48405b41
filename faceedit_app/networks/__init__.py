"""The region networks (torch): models, their files, and answering in process."""
