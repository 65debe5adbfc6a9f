"""What several test modules share: machines, files, robots, comparisons."""
