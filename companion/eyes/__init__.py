"""The camera program: from the pixels of a frame to where the pad is; of the project it imports only `link`."""
