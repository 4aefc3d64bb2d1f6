// Runs a program of ours as a user does, with the validation layers on, and keeps what it says.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "scene/files.h"
#include "support/temp_folder.h"

namespace alabaster::test {

struct Outcome {
  int status = -1;  // exit status; 128 + signal where one ended it
  std::string out, err;
};

inline std::string quoted(const std::string& word) {
  std::string text = "'";
  for (char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// `program` is a name in the build's bin folder; `environment` are NAME=VALUE words.
inline Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                           const std::string& environment = "") {
  const TempFolder folder;
  std::string line = "ALABASTER_VALIDATION=1 " + environment + " " + quoted(std::string(ALABASTER_BIN) + "/" + program);
  for (const std::string& argument : arguments) line += " " + quoted(argument);
  line += " >" + quoted(folder / "out") + " 2>" + quoted(folder / "err") + " </dev/null";
  const int code = std::system(line.c_str());
  Outcome outcome;
  outcome.status = WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code);
  outcome.out = read_file(folder / "out");
  outcome.err = read_file(folder / "err");
  return outcome;
}

}  // namespace alabaster::test
