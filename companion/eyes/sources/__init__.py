"""Where frames come from: a camera, a video, pictures in a folder, or Zenoh."""

PIXELS_MAX = 1 << 26
"""Of a picture that comes as a file, as many as a raw one may have: OpenCV itself makes a gigabyte of one of 1 MB."""
