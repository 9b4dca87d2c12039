"""Where the pad is in a picture: its tags, their edges, and the pose that explains them."""
