#pragma once

#include "byre/viewer/web_guests.h"

namespace byre {

// Place of a connection in WebGuests, released on destruction.
class WebSeat {
 public:
  // The guests outlive this.
  WebSeat(WebGuests& guests, WebGuests::Id id) : guests_(guests), id_(id) {}
  ~WebSeat() { guests_.leave(id_); }
  WebSeat(const WebSeat&) = delete;
  WebSeat& operator=(const WebSeat&) = delete;

  bool introduce() { return guests_.introduce(id_); }

 private:
  WebGuests& guests_;
  WebGuests::Id id_;
};

}  // namespace byre
