# Makes data.csv and reference.csv beside this file: analyses of variance by R's aov and car::Anova.
#   Rscript tests/stats/anova/reference.R        (R 4.2.2, car 3.1-1)
# statsmodels 0.13 (anova_lm of ols with C(., Sum), typ 1 to 3, robust "hc0" and "hc3" of type 3) agrees with these
# values to 5e-13 in sums of squares and F on every set but empty3, whose model it inverts by a pseudo-inverse.
# reference.csv: set, kind, covariance, term, degrees, sum_of_squares, F, log(p); sums are empty for robust tests.
suppressMessages(library(car))
options(contrasts = c("contr.sum", "contr.poly"), digits = 17)
here <- dirname(sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)))
data <- list(); reference <- list()
text <- function(x) ifelse(is.na(x), "", formatC(x, digits = 17, format = "g"))
add <- function(set, kind, covariance, table, sums = TRUE) {
  f <- table[["F value"]]; if (is.null(f)) f <- table[["F"]]
  rows <- which(!is.na(f) & !(rownames(table) %in% c("(Intercept)", "Residuals")))
  rest <- table[nrow(table), "Df"]
  reference[[length(reference) + 1]] <<- data.frame(set, kind, covariance, term = trimws(rownames(table))[rows],
    degrees = table[rows, "Df"], sum_of_squares = text(if (sums) table[rows, "Sum Sq"] else NA), F = text(f[rows]),
    log_p = text(pf(f[rows], table[rows, "Df"], rest, lower.tail = FALSE, log.p = TRUE)))
}
study <- function(set, d, formula, types = 1:3, robust = character()) {
  for (v in c("a", "b", "c", "d", "e")) if (is.null(d[[v]])) d[[v]] <- ""
  data[[length(data) + 1]] <<- data.frame(set, d[, c("a", "b", "c", "d", "e")], y = text(d$y))
  for (v in c("a", "b", "c", "d", "e")) d[[v]] <- factor(d[[v]])
  model <- lm(formula, d)
  if (1 %in% types) { t <- summary(aov(formula, d))[[1]]; add(set, "1", "classical", t) }
  if (2 %in% types) add(set, "2", "classical", Anova(model, type = 2))
  if (3 %in% types) add(set, "3", "classical", Anova(model, type = 3))
  for (w in robust) for (type in setdiff(types, 1))
    add(set, as.character(type), w, suppressMessages(Anova(model, type = type, white.adjust = w)), FALSE)
}
grid <- function(...) { g <- expand.grid(...); as.data.frame(lapply(g, as.character)) }
robust <- c("hc0", "hc1", "hc2", "hc3")
set.seed(20180601)

d <- grid(a = 1:3, b = 1:4, rep = 1:3); d$y <- 5 + as.numeric(d$a) * (as.numeric(d$b) == 2) + rnorm(nrow(d))
study("balanced2", d, y ~ a * b, robust = robust)

d <- grid(a = 1:4, b = 1:3, c = 1:2, rep = 1:3); d <- d[sort(sample(nrow(d), 51)), ]
d$y <- 10 + 0.7 * as.numeric(d$a) - 0.5 * as.numeric(d$b) * as.numeric(d$c) + exp(0.3 * as.numeric(d$a)) * rnorm(nrow(d))
study("unbalanced3", d, y ~ (a + b + c)^2, robust = robust)

d <- grid(a = 1:4, b = 1:2, c = 1:3, d = 1:3, e = 1:2, rep = 1:2); d <- d[sort(sample(nrow(d), 190)), ]
d$y <- 50 + 6 * as.numeric(d$a) + 4 * as.numeric(d$c) * (as.numeric(d$e) - 1) + (1 + as.numeric(d$b)) * rnorm(nrow(d))
study("unbalanced5", d, y ~ (a + b + c + d + e)^2, robust = robust)

# Some cells of a:b have nobody; type III of such a table is not a matter of agreement, I and II are.
d <- grid(a = 1:4, b = 1:3, c = 1:2, rep = 1:2); d <- d[!(d$a == "1" & d$b == "3") & !(d$a == "4" & d$b == "2"), ]
d <- d[-c(3, 17, 30), ]; d$y <- as.numeric(d$a) + 2 * as.numeric(d$c) + rnorm(nrow(d))
study("empty3", d, y ~ (a + b + c)^2, types = 1:2)

# Tails: effects of many sigmas.
d <- grid(a = 1:8, b = 1:5, rep = 1:8); d <- d[sort(sample(nrow(d), 290)), ]
d$y <- 3 * as.numeric(d$a) + 0.4 * as.numeric(d$b) + 0.8 * rnorm(nrow(d))
study("tails", d, y ~ a + b, robust = robust)

write.csv(do.call(rbind, data), file.path(here, "data.csv"), row.names = FALSE, quote = FALSE)
write.csv(do.call(rbind, reference), file.path(here, "reference.csv"), row.names = FALSE, quote = FALSE)
