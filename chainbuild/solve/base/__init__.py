"""What every solver is asked and answers: limits, starts, results, options."""
