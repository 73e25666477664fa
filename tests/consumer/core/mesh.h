#error "A header of fairway took this file of another project for its own."
