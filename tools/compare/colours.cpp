// See colours.h.
#include "tools/compare/colours.h"

#include "colour/colour_document.h"
#include "colour/correction.h"
#include "manifest/image_list.h"

namespace gonio::tools::compare {

cli::Option colour_option() {
  return {.name = "colour",
          .type = cli::Type::text,
          .help = "Compare photographs as colours: this correction of the manifest, as color-calib found it.",
          .metavar = "NAME",
          .conflicts = {"reference"}};
}

std::vector<metric::Entry> in_colours(const cli::Invocation& call, std::vector<metric::Entry> entries) {
  if (!call.given("colour")) return entries;
  for (metric::Entry& entry : entries) {
    const std::size_t image = manifest::index_of_image(call.document, entry.image).value();
    const colour::Correction correction = colour::correction_for(call.document, call.text("colour"), image);
    entry.prepare = [correction, place = entry.photograph_place](photograph::LinearPicture& picture,
                                                                 std::optional<manifest::Noise>& noise) {
      colour::correct(correction, picture, noise, place);
    };
  }
  return entries;
}

}  // namespace gonio::tools::compare
