#include <memory>

#include "arguments.h"
#include "commands.h"
#include "reference/reference.h"

namespace alabaster {

void add_merge(CLI::App& app) {
  struct Arguments {
    std::vector<std::string> parts;
    std::string output;
  };
  auto* command =
      app.add_subcommand("merge", "adds up parts of one reference rendered with different seeds, weighted by samples");
  auto a = std::make_shared<Arguments>();
  command->add_option("parts", a->parts, "reference pictures (EXR)")->required();
  command->add_option("-o,--output", a->output, "their sum (EXR)")->required();
  command->callback([a] {
    check_writable(a->output);
    std::vector<Picture> pictures;
    for (const std::string& part : a->parts) pictures.push_back(read_exr(part));
    write_exr(merge(pictures, a->parts), a->output);
  });
}

}  // namespace alabaster
