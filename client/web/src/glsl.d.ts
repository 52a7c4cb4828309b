// Texts that esbuild puts into the bundle (--loader:.glsl=text).
declare module "*.glsl" {
  const text: string;
  export default text;
}
