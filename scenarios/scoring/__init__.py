"""What a landing was worth, from ground truth alone."""
