#pragma once

#include "byre/io/bag/bag.h"
#include "byre/playback/report/report.h"

#include <string>

namespace byre {

// Content of a bag. bag: its path.
Report bag_report(const BagContent& content, const std::string& bag);

}  // namespace byre
