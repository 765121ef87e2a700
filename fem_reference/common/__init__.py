"""What every room of the reference uses: limits, and names of the stages for messages."""
