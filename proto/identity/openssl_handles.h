// Owners of OpenSSL's objects. Only the sources of this folder include this.
#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <memory>
#include <string>
#include <string_view>

#include "renderer/util/check.h"

namespace tessera {

template <auto kFree>
struct OpensslDeleter {
  template <typename Object>
  void operator()(Object* object) const {
    kFree(object);
  }
};

template <typename Object, auto kFree>
using OpensslOwner = std::unique_ptr<Object, OpensslDeleter<kFree>>;

using BioOwner = OpensslOwner<BIO, BIO_free_all>;

inline BioOwner ReadOnlyBio(std::string_view bytes) {
  BioOwner bio(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
  TESSERA_CHECK(bio != nullptr);
  return bio;
}

// What `write`, an int(BIO*), writes.
template <typename Write>
std::string BioText(Write write) {
  const BioOwner bio(BIO_new(BIO_s_mem()));
  TESSERA_CHECK(bio != nullptr && write(bio.get()) == 1);
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &bytes);
  return {bytes, static_cast<size_t>(size)};
}

}  // namespace tessera
