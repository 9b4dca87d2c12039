"""Where frames come from: a camera, a video, pictures in a folder, or Zenoh."""
