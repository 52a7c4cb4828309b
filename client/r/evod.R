# Reads the results of evod in R: run files (docs/RUN_FILE.md), and the CSV files of `evod run --csv` and `evod sweep`.
#
#     Rscript evod.R FILE [FIGURE]     prints a table of the generations, and draws the fitness: FIGURE is .png, .svg or .pdf
#     source("evod.R")                 defines the functions below
#
# Run files need the package RSQLite (Debian: r-cran-rsqlite). Seeds are texts, because a number of R is exact only up to
# 2^53. 64-bit integers of run files are texts for the same reason.

#' Opens a run file for reading, also while a server writes it. Close it with DBI::dbDisconnect(run).
open_run <- function(path) {
  if (!file.exists(path)) stop("there is no run file ", path)
  DBI::dbConnect(RSQLite::SQLite(), path, flags = RSQLite::SQLITE_RO, bigint = "character")
}

#' The settings of a run, a list of texts: settings$seed, settings$name, settings$gene_names.
run_settings <- function(run) {
  rows <- DBI::dbGetQuery(run, "SELECT key, value FROM run")
  as.list(setNames(rows$value, rows$key))
}

#' The statistics of all ended generations: a data frame with a row for each generation and island.
run_generations <- function(run) {
  rows <- DBI::dbGetQuery(run, "SELECT * FROM statistics ORDER BY generation, island")
  rows[names(rows) != "checksum"]
}

#' The choices of the genes that contain the index of one: a list of texts by the name of the gene.
run_choices <- function(run) {
  rows <- DBI::dbGetQuery(run, "SELECT json_extract(gene.value, '$.name') AS name, choice.value AS text
                                FROM run, json_each(run.value, '$.free_genes') AS gene,
                                     json_each(gene.value, '$.choices') AS choice
                                WHERE run.key = 'parameters' AND gene.type = 'object'
                                ORDER BY choice.key")
  split(as.character(rows$text), rows$name)
}

#' The organisms of a generation: a data frame with their parents, genes, and after its end their fitness. A gene that
#' is a choice is the text of the choice. Fails if the file does not retain the generation.
run_organisms <- function(run, generation) {
  born <- DBI::dbGetQuery(run, "SELECT * FROM population WHERE generation = ? ORDER BY island", list(generation))
  if (nrow(born) == 0) stop("the file has no organisms of generation ", generation)
  genes <- strsplit(c(run_settings(run)$gene_names, body_genes)[1], ",")[[1]]
  choices <- run_choices(run)
  do.call(rbind, lapply(seq_len(nrow(born)), function(i) {
    count <- born$organism_count[i]
    chromosomes <- readBin(born$chromosomes[[i]], "numeric", count * length(genes), size = 4, endian = "little")
    rows <- data.frame(generation, island = born$island[i], organism = seq_len(count) - 1,
                       matrix(chromosomes, count, byrow = TRUE, dimnames = list(NULL, genes)), check.names = FALSE)
    for (gene in intersect(genes, names(choices))) rows[[gene]] <- choices[[gene]][rows[[gene]] + 1]
    parents <- unsigned(born$parents[[i]])
    rows$parent_first <- if (length(parents)) parents[c(TRUE, FALSE)] else NA
    rows$parent_second <- if (length(parents)) parents[c(FALSE, TRUE)] else NA
    end <- DBI::dbGetQuery(run, "SELECT fitness FROM outcome WHERE generation = ? AND island = ?",
                           list(generation, born$island[i]))
    rows$fitness <- if (nrow(end)) readBin(end$fitness[[1]], "numeric", count, size = 8, endian = "little") else NA
    rows
  }))
}

body_genes <- "normal_speed,impulse,body_size,base_health,food_radius,poison_radius"

# 32-bit numbers without a sign, as R has none.
unsigned <- function(bytes) {
  numbers <- as.double(readBin(bytes, "integer", length(bytes) / 4, size = 4, endian = "little"))
  ifelse(numbers < 0, numbers + 2^32, numbers)
}

#' Reads the CSV file of `evod run --csv` or the runs.csv of `evod sweep`; the seeds are texts.
read_evod_csv <- function(path) {
  head <- readLines(path, n = 1000)
  names <- strsplit(head[!startsWith(head, "#")][1], ",")[[1]]
  kinds <- rep(NA, length(names))
  kinds[names == "seed"] <- "character"
  read.csv(path, comment.char = "#", check.names = FALSE, colClasses = kinds)
}

#' One row for each generation: the best fitness of all islands, and the mean over all organisms. With a sweep, one for
#' each cell and generation: means over the replicates.
fitness_by_generation <- function(rows) {
  keys <- intersect(c("cell", "replicate", "generation"), names(rows))
  rows$fitness_sum <- rows$fitness_mean * rows$organism_count
  best <- aggregate(rows["fitness_best"], rows[keys], max)
  sums <- aggregate(rows[c("fitness_sum", "organism_count")], rows[keys], sum)
  found <- merge(best, sums, sort = FALSE)
  found$fitness_mean <- found$fitness_sum / found$organism_count
  found <- aggregate(found[c("fitness_best", "fitness_mean")], found[setdiff(keys, "replicate")], mean)
  found[do.call(order, found[setdiff(keys, "replicate")]), ]
}

#' Draws the best and the mean fitness over the generations; of a sweep, the mean fitness of each cell.
plot_fitness <- function(rows) {
  found <- fitness_by_generation(rows)
  if ("cell" %in% names(found)) {
    curves <- tapply(found$fitness_mean, found[c("generation", "cell")], c)
    colors <- hcl.colors(ncol(curves), "viridis")
    labels <- paste("cell", colnames(curves))
  } else {
    curves <- as.matrix(found[c("fitness_mean", "fitness_best")])
    rownames(curves) <- found$generation
    colors <- c("#1f77b4", "#ff7f0e")
    labels <- c("mean", "best")
  }
  matplot(as.numeric(rownames(curves)), curves, type = "l", lty = 1, col = colors, xlab = "generation", ylab = "fitness")
  legend("topleft", labels, lty = 1, col = colors, bty = "n", cex = 0.8)
}

main <- function(file, figure = NULL) {
  connection <- file(file, "rb")
  is_run_file <- identical(readBin(connection, "raw", 15), charToRaw("SQLite format 3"))
  close(connection)
  if (is_run_file) {
    run <- open_run(file)
    settings <- run_settings(run)
    cat("world ", settings$name, ", seed ", settings$seed, ", run ", settings$run_id, "\n", sep = "")
    rows <- run_generations(run)
    DBI::dbDisconnect(run)
  } else {
    rows <- read_evod_csv(file)
    if ("seed" %in% names(rows)) cat("seeds ", paste(unique(rows$seed), collapse = ", "), "\n", sep = "")
  }
  if (nrow(rows) == 0) stop("no generation has ended yet")
  print(fitness_by_generation(rows), row.names = FALSE)
  if (!is.null(figure)) {
    switch(tools::file_ext(figure),
           png = png(figure, 800, 500, type = "cairo"), svg = svg(figure, 8, 5), pdf = pdf(figure, 8, 5),
           stop("FIGURE: got ", figure, ", allowed a name that ends in .png, .svg or .pdf"))
    plot_fitness(rows)
    invisible(dev.off())
  }
}

if (sys.nframe() == 0) {
  words <- commandArgs(trailingOnly = TRUE)
  if (!length(words) %in% 1:2) stop("write: Rscript evod.R FILE [FIGURE]")
  do.call(main, as.list(words))
}
