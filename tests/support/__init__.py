"""What tests share: small characters, takes, films, and a window with its slow parts replaced."""
