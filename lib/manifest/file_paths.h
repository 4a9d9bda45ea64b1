// The rule of paths: where a file that a manifest names lies, and whether it lies within the manifest's folder.
//
// 1. An entry of `files` is absolute, or starts at the folder of the manifest; that of standard input and of a document
//    that was never read is the working directory.
// 2. ".." is taken by the letters of the path, before any link is followed (a/link/../b is a/b), so that an entry means
//    the same place for the program that writes it and for the one that reads it. Above the root there is the root.
// 3. A file is entered, and an entry is moved to another folder, as the shortest way by letters from the one absolute
//    folder to the other absolute place.
// 4. A file lies within the folder where its real place, links followed, is below the folder's real place, compared
//    name by name (/tmp/xy is not below /tmp/x). What does not is refused unless outside is allowed.
//
// An entry means something only together with its folder: whoever gives a document another folder moves its entries
// along (move_to_folder). Where the working directory or a temporary folder lie makes no difference.
#pragma once
#include <filesystem>
#include <string>

#include "manifest/document.h"

namespace gonio::manifest {

std::filesystem::path place_of_entry(const std::filesystem::path& folder, const std::string& entry);
std::string entry_for(const std::filesystem::path& place, const std::filesystem::path& folder);
bool lies_within(const std::filesystem::path& place, const std::filesystem::path& folder);

// The document's files stay where they are; its entries are written for `folder`, which becomes its own.
void move_to_folder(Document& document, const std::filesystem::path& folder);

}  // namespace gonio::manifest
