// An analysis as files: CSV for programs, LaTeX (booktabs) for papers. See analysis.h.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "nrsfm/evaluate/analysis.h"

namespace gonio::nrsfm {
namespace {

using stats::MarginalMean;
using stats::Term;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

std::string field(const std::string& text) {  // RFC 4180
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}
std::string number(double v) {
  return std::isfinite(v) ? shortest_text(v) : "";
}
const std::string& level_name(const Part& part, const Term& term, const std::vector<int>& levels, std::size_t i) {
  return part.design.factors[at(term[i])].levels[at(levels[i])];
}

std::string anova_csv(const Analysis& analysis) {
  std::string csv = "part,term,degrees,sum_of_squares,mean_square,F,p,log10_p,significant,aliased\n";
  for (const Part& part : analysis.parts) {
    for (const stats::TermRow& r : part.anova.rows)
      csv += part.id + "," + field(stats::term_name(part.design, r.term)) + "," + std::to_string(r.degrees) + "," +
             number(r.sum_of_squares) + "," + number(r.mean_square) + "," + number(r.f) + "," + number(r.p) + "," +
             number(r.log10_p) + "," + (r.p < analysis.options.significance ? "yes" : "no") + "," +
             std::to_string(r.aliased) + "\n";
    const stats::Anova& fit = part.anova;
    csv += part.id + ",error," + std::to_string(fit.residual_degrees) + "," + number(fit.residual_sum_of_squares) +
           "," + number(fit.residual_sum_of_squares / fit.residual_degrees) + ",,,,,\n";
    csv +=
        part.id + ",total," + std::to_string(fit.total_degrees) + "," + number(fit.total_sum_of_squares) + ",,,,,,\n";
  }
  return csv;
}

std::string means_csv(const Analysis& analysis) {
  std::string csv = "part,term,level_1,level_2,mean,sigma,results\n";
  for (const Part& part : analysis.parts)
    for (const MeansTable& table : part.tables)
      for (const MarginalMean& m : table.means) {
        std::string second;
        for (std::size_t i = 1; i < m.levels.size(); ++i)
          second += (i > 1 ? ":" : "") + level_name(part, table.term, m.levels, i);
        csv += part.id + "," + field(stats::term_name(part.design, table.term)) + "," +
               field(level_name(part, table.term, m.levels, 0)) + "," + field(second) + "," + number(m.value) + "," +
               number(m.sigma) + "," + std::to_string(m.observations) + "\n";
      }
  return csv;
}

std::string ranks_csv(const Analysis& analysis) {
  std::string csv = "part,factor,level,mean,rank,lower,upper,best_share\n";
  for (const Part& part : analysis.parts)
    for (const stats::Rank& r : part.ranks) {
      const stats::Factor& f = part.design.factors[at(part.ranked)];
      csv += part.id + "," + field(f.name) + "," + field(f.levels[at(r.level)]) + "," + number(r.mean) + "," +
             number(r.rank) + "," + number(r.lower) + "," + number(r.upper) + "," + number(r.best_share) + "\n";
    }
  return csv;
}

std::string empty_csv(const Analysis& analysis) {
  std::string csv = "part,cell\n";
  for (const Part& part : analysis.parts)
    for (const Factors& cell : part.empty_cells) {
      std::string text;
      for (const auto& [name, level] : cell) text += (text.empty() ? "" : ";") + name + "=" + level;
      csv += part.id + "," + field(text) + "\n";
    }
  return csv;
}

std::string tex(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\': out += "\\textbackslash{}"; break;
      case '~': out += "\\textasciitilde{}"; break;
      case '^': out += "\\textasciicircum{}"; break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}': out += std::string("\\") + c; break;
      default: out += c;
    }
  }
  return out;
}

// "5.5\times 10^{-242}" as mathematics; two digits, as the paper prints.
std::string tex_power(double log10) {
  double exponent = std::floor(log10), digits = std::round(std::pow(10.0, log10 - exponent + 1)) / 10;
  if (digits >= 10) digits = 1, ++exponent;
  return format("$%.1f\\times10^{%.0f}$", digits, exponent);
}
std::string tex_number(double v) {
  if (!std::isfinite(v)) return "--";
  if (v > 0 && (v >= 1e5 || v < 1e-3)) return tex_power(std::log10(v));
  return format("$%.*f$", v >= 100 || v == 0 ? 0 : v >= 10 ? 1 : v >= 1 ? 2 : 3, v);
}
std::string tex_p(const stats::TermRow& row) {
  if (std::isnan(row.p)) return "--";
  if (std::isinf(row.log10_p)) return "$0$";
  return row.log10_p < -3 ? tex_power(row.log10_p) : format("$%.2g$", row.p);
}

std::string begin_table(const std::string& caption, const std::string& columns) {
  return "\\begin{table}\n  \\centering\n  \\caption{" + caption + "}\n  \\begin{tabular}{" + columns +
         "}\n    \\toprule\n";
}
constexpr const char* end_table = "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n\n";

std::string anova_tex(const Analysis& analysis, const Part& part) {
  const char* types[] = {"I", "II", "III"};
  std::string text = begin_table(
      format("Analysis of variance (type %s), %s.", types[static_cast<int>(analysis.options.type)], part.title.c_str()),
      "lrrrrr");
  text += "    Factor & Sum sq. & DoF & Mean sq. & $F$ & $p$ \\\\\n    \\midrule\n";
  for (const stats::TermRow& r : part.anova.rows)
    text += "    " + tex(stats::term_name(part.design, r.term)) + " & " + tex_number(r.sum_of_squares) + " & " +
            std::to_string(r.degrees) + " & " + tex_number(r.mean_square) + " & " + tex_number(r.f) + " & " + tex_p(r) +
            " \\\\\n";
  const stats::Anova& fit = part.anova;
  text += "    \\midrule\n    Error & " + tex_number(fit.residual_sum_of_squares) + " & " +
          std::to_string(fit.residual_degrees) + " & " +
          tex_number(fit.residual_sum_of_squares / fit.residual_degrees) + " & & \\\\\n";
  text += "    Total & " + tex_number(fit.total_sum_of_squares) + " & " + std::to_string(fit.total_degrees) +
          " & & & \\\\\n";
  return text + end_table;
}

std::string mean_caption(const Analysis& analysis, const Part& part, const MeansTable& table) {
  std::string terms;
  for (const char c : table.formula) terms += c == ':' ? std::string("$\\times$") : tex(std::string(1, c));
  terms.replace(0, 2, "$\\mu$");
  return tex(analysis.measure) + ", " + terms + (analysis.unit.empty() ? "" : ", in " + tex(analysis.unit)) + "; " +
         part.title + ".";
}

// Means of a pair: rows by the first factor, columns by the second, the least of each column bold.
std::string pair_tex(const Analysis& analysis, const Part& part, const MeansTable& table) {
  const std::size_t columns = part.design.factors[at(table.term[1])].levels.size();
  std::vector<const MarginalMean*> least(columns, nullptr);
  for (std::size_t i = 0; i < table.means.size(); ++i) {
    const MarginalMean& m = table.means[i];
    const MarginalMean*& best = least[i % columns];
    if (m.estimable && (best == nullptr || m.value < best->value)) best = &m;
  }
  std::string text = begin_table(mean_caption(analysis, part, table), "l" + std::string(columns, 'r')) + "    ";
  for (std::size_t c = 0; c < columns; ++c) text += " & " + tex(level_name(part, table.term, table.means[c].levels, 1));
  text += " \\\\\n    \\midrule\n";
  for (std::size_t i = 0; i < table.means.size(); ++i) {
    const MarginalMean& m = table.means[i];
    if (i % columns == 0) text += "    " + tex(level_name(part, table.term, m.levels, 0));
    const std::string shown = m.estimable ? format("%.*f", std::abs(m.value) < 1 ? 4 : 2, m.value) : "--";
    text += " & " + (&m == least[i % columns] ? "\\textbf{" + shown + "}" : shown);
    if (i % columns == columns - 1) text += " \\\\\n";
  }
  return text + end_table;
}

std::string single_tex(const Analysis& analysis, const Part& part, const MeansTable& table) {
  std::string text = begin_table(mean_caption(analysis, part, table), "lrrr") + "    " +
                     tex(stats::term_name(part.design, table.term)) +
                     " & Mean & $\\sigma$ & Results \\\\\n    \\midrule\n";
  for (const MarginalMean& m : table.means)
    text += "    " + tex(level_name(part, table.term, m.levels, 0)) + " & " +
            (m.estimable ? format("%.*f & %.2g", std::abs(m.value) < 1 ? 4 : 2, m.value, m.sigma) : "-- & --") + " & " +
            std::to_string(m.observations) + " \\\\\n";
  return text + end_table;
}

std::string ranks_tex(const Analysis& analysis, const Part& part) {
  const stats::Factor& f = part.design.factors[at(part.ranked)];
  std::string text = begin_table(
      format("Ranks with %g\\,\\%% intervals, %s.", 100 * analysis.options.confidence, part.title.c_str()), "lrrrr");
  text += "    " + tex(f.name) + " & Mean & Rank & Interval & Best \\\\\n    \\midrule\n";
  for (const stats::Rank& r : part.ranks)
    text += "    " + tex(f.levels[at(r.level)]) + " & " + (std::isfinite(r.mean) ? format("%.2f", r.mean) : "--") +
            format(" & %g & %g--%g & %.0f\\,\\%% \\\\\n", r.rank, r.lower, r.upper, 100 * r.best_share);
  return text + end_table;
}

}  // namespace

std::string p_text(const stats::TermRow& row) {
  if (std::isnan(row.p)) return "\u2013";
  if (std::isinf(row.log10_p)) return "0";
  if (row.log10_p > -3) return format("%.2g", row.p);
  double exponent = std::floor(row.log10_p), digits = std::round(std::pow(10.0, row.log10_p - exponent + 1)) / 10;
  if (digits >= 10) digits = 1, ++exponent;
  return format("%.1fe%.0f", digits, exponent);
}

std::string latex(const Analysis& analysis) {
  std::string text =
      "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage[T1]{fontenc}\n\\usepackage{booktabs}\n"
      "\\begin{document}\n\n";
  for (const Part& part : analysis.parts) {
    text += anova_tex(analysis, part);
    for (const MeansTable& table : part.tables)
      if (table.term.size() <= 2)
        text += table.term.size() == 1 ? single_tex(analysis, part, table) : pair_tex(analysis, part, table);
    if (!part.ranks.empty()) text += ranks_tex(analysis, part);
    text += "\\clearpage\n";  // LaTeX holds a few floats at a time
  }
  return text + "\\end{document}\n";
}

std::map<std::string, std::string> analysis_files(const Analysis& analysis) {
  return {{"anova.csv", anova_csv(analysis)},
          {"means.csv", means_csv(analysis)},
          {"ranks.csv", ranks_csv(analysis)},
          {"empty-cells.csv", empty_csv(analysis)},
          {"tables.tex", latex(analysis)}};
}

}  // namespace gonio::nrsfm
