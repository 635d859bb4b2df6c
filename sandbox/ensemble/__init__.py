"""Many runs: processes that carry them out, in batches, on a clock of their own, and how sure what they come to is."""
