// What outlines and alignments name.
#include "manifest/codec.h"
#include "manifest/document_references_parts.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/file.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"

namespace gonio::manifest {
namespace {

void must_be_object(const Document& d, const std::string& id, const std::string& where) {
  for (const Object& object : d.objects)
    if (object.id == id) return;
  throw Error(Exit::data, where, "names \"" + id + "\", which is not in objects");
}

}  // namespace

// Lamps and cameras of an alignment are those that it was made with: they may have gone since.
void check_alignments(const Document& d) {
  for (std::size_t i = 0; i < d.outlines.size(); ++i) {
    const Outline& outline = d.outlines[i];
    const std::string at = place(d, "/outlines/" + std::to_string(i));
    if (!index_of_image(d, outline.image))
      throw Error(Exit::data, at + "/image", "names \"" + outline.image + "\", which is not in images");
    must_be_object(d, outline.object, at + "/object");
    must_exist(d.lights, "lights", outline.light, at + "/light");
    must_exist(d.files, "files", outline.mask, at + "/mask");
    must_exist(d.files, "files", outline.file, at + "/file");
  }
  for (std::size_t i = 0; i < d.alignments.size(); ++i)
    must_be_object(d, d.alignments[i].object, place(d, "/alignments/" + std::to_string(i) + "/object"));
}

}  // namespace gonio::manifest
