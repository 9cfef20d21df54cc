"""What is drawn in the 3D scene: each part takes what is shown, and updates the browser's nodes."""
