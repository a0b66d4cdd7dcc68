"""The program's analyses in this process: runs, static analyses, modes, what a case holds."""
