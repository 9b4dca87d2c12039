"""The live view: a page with a 3-D scene, a panel and plots, of a landing on Zenoh or of a recording."""
