"""A gallery to publish: players of every scene, worksheets to print, what was measured; pages that ask for nothing."""
