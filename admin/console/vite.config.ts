import { readFileSync } from 'node:fs';
import { defineConfig, type Plugin } from 'vite';

// Leaflet's style sheet names pictures of markers and a layers button that the console never shows.
const withoutPictures: Plugin = {
  name: 'without-pictures',
  enforce: 'pre',
  transform: (code, id) => (id.endsWith('leaflet.css') ? code.replace(/[^{};]*url\([^)]*\)[^;}]*;?/g, '') : undefined),
};

// What the bundle is made of, with the licences their authors ask to be kept beside it.
const kParts = ['preact', 'leaflet', 'leaflet-editable', 'lucide-preact', '@fontsource-variable/inter'];
const licences: Plugin = {
  name: 'licences',
  generateBundle() {
    const source = kParts.map((part) => {
      const { version, license } = JSON.parse(readFileSync(`node_modules/${part}/package.json`, 'utf8'));
      let text = '';
      try {
        text = readFileSync(`node_modules/${part}/LICENSE`, 'utf8').trim();
      } catch {
        text = `Licence: ${license}`;
      }
      return `${part} ${version}\n\n${text}\n`;
    });
    this.emitFile({ type: 'asset', fileName: 'licences.txt', source: source.join(`\n${'-'.repeat(72)}\n\n`) });
  },
};

export default defineConfig({
  base: './',
  plugins: [withoutPictures, licences],
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    cssCodeSplit: false,
    modulePreload: false,
    reportCompressedSize: false,
    rollupOptions: {
      output: {
        entryFileNames: 'console.js',
        assetFileNames: (asset) => (asset.names[0]?.endsWith('.woff2') ? 'inter.woff2' : 'console[extname]'),
      },
    },
  },
  // `npm run dev` shows the page against a running server: WAYFUSE_URL=http://127.0.0.1:8420 npm run dev
  server: { proxy: { '/v1': { target: process.env.WAYFUSE_URL ?? 'http://127.0.0.1:8420', ws: true } } },
});
