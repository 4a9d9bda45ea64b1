// The options of brdf-fit, as data.
#include "tools/brdf-fit/call.h"

namespace gonio::tools::brdf_fit {

using cli::Type;

namespace {

std::vector<cli::Option> reading_options() {
  return {
      {.name = "columns",
       .type = Type::text,
       .help =
           "What the table's columns are, pairs QUANTITY=COLUMN[:UNIT] joined by commas. Quantities: theta_i, phi_i "
           "(light), theta_o, phi_o (eye), f, sigma, wavelength, channel, series; a column is its name, its place "
           "#3, or a number for all rows, @180.",
       .metavar = "PAIRS",
       .repeat = true},
      {.name = "angles",
       .type = Type::choice,
       .help = "Unit of angles in tables whose headings state none.",
       .choices = {"deg", "rad"}},
      {.name = "mirror",
       .type = Type::choice,
       .help = "Azimuth of the mirror direction against the light's, in degrees; auto finds it where the surface has a "
               "lobe.",
       .preset = "auto",
       .choices = {"auto", "180", "0"}},
      {.name = "bands",
       .type = Type::text,
       .help = "Keep these bands only: names, or ranges of wavelengths such as 450nm:650nm, joined by commas.",
       .metavar = "BANDS",
       .repeat = true},
      {.name = "grazing",
       .type = Type::quantity,
       .help = "Leave out rows whose light or eye is farther from the normal.",
       .preset = "85deg",
       .dimension = Dimension::angle,
       .lower = 0.0873,
       .upper = 1.5708},
      {.name = "noise",
       .type = Type::quantity,
       .help = "Relative standard uncertainty of values in tables that state none; left out, it is not known.",
       .dimension = Dimension::ratio,
       .lower = 1e-6,
       .upper = 1},
      {.name = "table",
       .type = Type::text,
       .help = "Fit this table of the manifest.",
       .metavar = "NAME",
       .repeat = true},
      {.name = "sample",
       .type = Type::text,
       .help = "Fit this goniometer sample of the manifest.",
       .metavar = "NAME",
       .repeat = true}};
}

std::vector<cli::Option> fitting_options() {
  return {
      {.name = "model",
       .type = Type::text,
       .help = "Try this surface only; may be repeated. Left out: every registered one.",
       .metavar = "ID",
       .repeat = true},
      {.name = "lobes",
       .type = Type::integer,
       .help = "Most lobes of one surface.",
       .preset = "2",
       .lower = 1,
       .upper = 8},
      {.name = "isotropic",
       .type = Type::flag,
       .help = "Try no surface that changes when it is turned about its normal.",
       .conflicts = {"anisotropic"}},
      {.name = "anisotropic", .type = Type::flag, .help = "Try such surfaces in any case."},
      {.name = "scale",
       .type = Type::choice,
       .help = "On which scale fits err least: noise weighs by sigma, log1p compares log(1 + 100 f cos cos), log10 "
               "decades; auto is noise where sigma is stated, else log1p.",
       .preset = "auto",
       .choices = {"auto", "noise", "log1p", "log10"}},
      {.name = "starts",
       .type = Type::integer,
       .help = "Random starts of each fit, beside those that the samples suggest.",
       .preset = "4",
       .lower = 0,
       .upper = 1000},
      {.name = "folds",
       .type = Type::integer,
       .help = "Into how many parts directions are held out in turn; 0: none are.",
       .preset = "5",
       .lower = 0,
       .upper = 100},
      {.name = "reconstruct",
       .type = Type::flag,
       .help = "Instead of a model: the whole table that is most likely under a basis of materials."},
      {.name = "basis",
       .type = Type::text,
       .help = "Folder of MERL tables, or a saved basis, for --reconstruct and --plan; left out, one is generated from "
               "gonio's own models.",
       .metavar = "PATH"},
      {.name = "plan",
       .type = Type::integer,
       .help = "Print the N most informative pairs of directions for the basis, as CSV, and end; with a table, those "
               "that add most to it.",
       .metavar = "N",
       .lower = 1,
       .upper = 10000},
      {.name = "example", .type = Type::flag, .help = "Print a table to try the program on, and end."}};
}

std::vector<cli::Option> writing_options() {
  return {{.name = "name", .type = Type::text, .help = "Name of the surface; left out: the file's.", .metavar = "NAME"},
          {.name = "html",
           .type = Type::output_file,
           .help = "Write the report page here; with --out it is DIR/NAME.html."},
          {.name = "csv",
           .type = Type::output_file,
           .help = "Write the samples with prediction and residual here; with --out it is DIR/NAME.csv."},
          {.name = "merl",
           .type = Type::output_file,
           .help = "Write the surface as a table in MERL's format, 33 MB, here."},
          {.name = "merl-sigma",
           .type = Type::output_file,
           .help = "Write one standard deviation of every cell of the reconstructed table, in 1/sr and in the same "
                   "format, here; with --out it is DIR/NAME-sigma.binary.",
           .needs = {"reconstruct"}},
          {.name = "save-basis",
           .type = Type::output_file,
           .help = "Save the basis of --reconstruct here: --basis reads it in a second, and making it takes longer.",
           .needs = {"reconstruct"}}};
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = reading_options();
  for (auto& option : fitting_options()) all.push_back(std::move(option));
  for (auto& option : writing_options()) all.push_back(std::move(option));
  return all;
}

}  // namespace gonio::tools::brdf_fit
