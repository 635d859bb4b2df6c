"""Study: hard cases."""
