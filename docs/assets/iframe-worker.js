// Search in pages that were opened as files: a browser starts no worker from the disk, so its script runs in a frame.
"use strict"
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super()
      this.waiting = []
      const frame = document.createElement("iframe")
      frame.hidden = true
      document.documentElement.appendChild(frame)
      const inner = frame.contentWindow
      const deliver = inner.postMessage.bind(inner)
      inner.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }))
      inner.importScripts = (...urls) => urls.reduce((before, one) => before.then(() => load(inner, one)), Promise.resolve())
      this.postMessage = data => this.waiting.push(data)
      load(inner, String(url)).then(() => {
        this.postMessage = data => deliver(data, "*")
        this.waiting.forEach(data => deliver(data, "*"))
      })
    }
    terminate() {}
  }
  window.Worker = window.IFrameWorker
}

function load(inner, url) {
  return new Promise((resolve, reject) => {
    const script = inner.document.createElement("script")
    script.src = url
    script.onload = resolve
    script.onerror = reject
    inner.document.body.appendChild(script)
  })
}
