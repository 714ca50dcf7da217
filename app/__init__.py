"""The dashboard of Racing Hexapods: a server that runs robots of `hexapods`, and its page."""
